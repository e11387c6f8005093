#pragma once

#include <vector>

#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Lines of one width, with round caps and joints.
struct Stroke {
    double width_px = 0.0;
    /// Each has two points or more. A dot is two equal ones; a closed line ends where it begins.
    std::vector<std::vector<view::PixelPoint>> lines;
};

/// A layer as strokes: those of its halos, and those of its capsules.
struct LayerStrokes {
    std::vector<Stroke> halos;
    std::vector<Stroke> lines;
};

/// Capsules of one width that begin where the last one ends become one line.
[[nodiscard]] LayerStrokes strokes_of(const view::DrawList& list, const view::Layer& layer);

}  // namespace corda::render
