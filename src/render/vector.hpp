#pragma once

#include <memory>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// A page that draw lists are written to as lines, not as pixels.
struct PageDef {
    int width_px = 0;  ///< of the coordinates; 1 px is width_mm / width_px
    int height_px = 0;
    double width_mm = 0.0;
    std::string title = {};       ///< UTF-8; control characters are written as their numbers
    OnProgress on_progress = {};  ///< asked at each layer
};

/// A page of vector graphics. The same calls give the same bytes.
class VectorPage {
  public:
    VectorPage() = default;
    VectorPage(const VectorPage&) = delete;
    VectorPage& operator=(const VectorPage&) = delete;
    virtual ~VectorPage() = default;

    /// Draws a list, ground and all, with its top left corner at (x_px, y_px), and cuts off what is outside
    /// of it. Throws corda::Error (kInterrupted) if asked to stop.
    virtual void draw(const view::DrawList& list, int x_px, int y_px) = 0;
    /// Ends the page; returns the bytes of the file.
    [[nodiscard]] virtual std::string finish() = 0;
};

[[nodiscard]] std::unique_ptr<VectorPage> make_svg(const PageDef& def);

/// Throws corda::Error (kInternal) like all that it does, if cairo refuses something.
[[nodiscard]] std::unique_ptr<VectorPage> make_pdf(const PageDef& def);

}  // namespace corda::render
