#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/render/coverage.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Writes row `y` of a ground, `width` pixels of premultiplied RGBA, in a frame of `height` rows. Integer
/// arithmetic: between two levels of a channel, a fixed dither pattern of 8 x 8 pixels mixes both.
void write_ground_row(const Ground& ground, int y, int width, int height, std::uint8_t* rgba);

class GroundRows {
  public:
    /// Pixels repeat along a row with this period.
    static constexpr int kPeriodPx = 8;
    using Row = std::array<std::uint8_t, std::size_t{4} * kPeriodPx>;

    GroundRows(const Ground& ground, int height);

    [[nodiscard]] const Ground& ground() const { return ground_; }
    /// One period of pixels, starting at the left edge.
    [[nodiscard]] const Row& row(int y) const { return rows_[static_cast<std::size_t>(y)]; }
    void write(const PixelRect& part, Image& image) const;

  private:
    Ground ground_;
    std::vector<Row> rows_;
};

/// The colours of a ground for a program that interpolates them without regard to alpha: a fully transparent
/// end gets the colour of the other one.
[[nodiscard]] Ground straight_ends(const Ground& ground);

/// Masks of a layer in a rectangle, as OpenGL draws them. The pointers are to the first pixel.
struct Masks {
    /// Two bytes per pixel: coverage by the capsules and by their halos, 0 .. 255.
    const std::uint8_t* coverage = nullptr;
    const TintSums* sums = nullptr;  ///< per pixel; null unless the layer is tinted
    int row_px = 0;                  ///< pixels from one row to the next
};

/// Paints a layer in `rect`, a part of one of its runs of tiles, onto premultiplied colours: paint_over() and
/// TintSums::mean() for 8 pixels at a time.
void paint_run(const PixelRect& rect, Color color, const Masks& masks, const GroundRows& ground,
               Image& image);

/// Paints the stamps of a list, clipped to `part`, onto premultiplied colours.
void paint_stamps(const view::DrawList& list, const PixelRect& part, Image& image);

/// Divides the colours in `part` by their alpha.
void straighten(const PixelRect& part, Image& image);

}  // namespace corda::render
