#pragma once

#include <vector>

#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Lines of one width and colour, with round caps and joints, or with blunt caps.
struct Stroke {
    double width_px = 0.0;
    Color color = {};  ///< that of its layer has the alpha
    bool is_blunt = false;
    /// Each has two points or more. A dot is two equal ones; a closed line ends where it begins.
    std::vector<std::vector<view::PixelPoint>> lines = {};
};

/// A layer as strokes: those of its halos, and those of its capsules.
struct LayerStrokes {
    std::vector<Stroke> halos;
    std::vector<Stroke> lines;
};

/// Capsules of one width that begin where the last one ends become one line. Those of a tinted layer follow
/// as long as their tints are the same: first with round caps, which fill the outsides of bends, then once
/// more with blunt ones, so that links in line meet at a sharp edge, and then its dots.
[[nodiscard]] LayerStrokes strokes_of(const view::DrawList& list, const view::Layer& layer);

/// The filled rectangles of a list. One that another of opaque colour follows on its right goes on below it,
/// or the ground would show between them where they end within a pixel.
[[nodiscard]] std::vector<view::Stamp> boxes_of(const view::DrawList& list);

}  // namespace corda::render
