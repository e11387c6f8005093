#pragma once

#include <memory>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Lines of one width and colour, with round joins and round or blunt caps.
struct Stroke {
    double width_px = 0.0;
    Color color = {};  ///< opaque: alpha belongs to the layer
    bool is_blunt = false;
    /// Each line has at least two points: a dot has two equal ones, and a closed line ends where it begins.
    std::vector<std::vector<view::PixelPoint>> lines = {};
};

struct LayerStrokes {
    std::vector<Stroke> halos;
    std::vector<Stroke> lines;
};

/// `list` with each layer whose capsules differ in strength as layers of even alpha. Each holds only the
/// capsules that are stronger than the layers below, so that no seam shows where capsules meet.
[[nodiscard]] view::DrawList in_even_layers(const view::DrawList& list);

/// Joins consecutive capsules of one width into lines; in a tinted layer, only those of one tint. A tinted
/// layer has its lines first with round caps, which fill the outside of bends, then with blunt ones, so that
/// collinear links meet at a sharp edge, and its dots last.
[[nodiscard]] LayerStrokes strokes_of(const view::DrawList& list, const view::Layer& layer);

/// The filled rectangles of a list. A rectangle with an opaque neighbour on its right extends one pixel below
/// it, so that the ground does not show through where they meet within a device pixel.
[[nodiscard]] std::vector<view::Stamp> boxes_of(const view::DrawList& list);

/// A page of vector graphics.
struct PageDef {
    int width_px = 0;
    int height_px = 0;
    double width_mm = 0.0;
    std::string title = {};  ///< UTF-8; control characters are escaped
};

/// A page of vector graphics. The same calls give the same bytes.
class VectorPage : NonCopyable {
  public:
    virtual ~VectorPage() = default;

    /// Draws a list with its ground, clipped to its size, with the top left corner at (x_px, y_px). Throws
    /// corda::Error (kInterrupted) if cancelled.
    virtual void draw(const view::DrawList& list, int x_px, int y_px) = 0;
    /// Ends the page; returns the bytes of the file.
    [[nodiscard]] virtual std::string finish() = 0;
};

/// This and all functions of the page throw corda::Error (kInternal) if cairo fails. Texts of an SVG are
/// outlines of their glyphs.
[[nodiscard]] std::unique_ptr<VectorPage> make_svg(const PageDef& def);
[[nodiscard]] std::unique_ptr<VectorPage> make_pdf(const PageDef& def);

}  // namespace corda::render
