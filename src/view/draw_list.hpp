#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/color.hpp"
#include "corda/core/image.hpp"

namespace corda::view {

/// A line with round caps, or a disc where `length` is 0: all points within `radius` of the segment.
///
/// Pixels, x to the right and y down, the centre of the top left pixel at (0.5, 0.5). (ax, ay) is a multiple
/// of 1/1024, so that differences to pixel centres are exact in float; (ux, uy) is the unit direction,
/// rounded once from double.
struct Capsule {
    float ax = 0;
    float ay = 0;
    float ux = 1;
    float uy = 0;
    float length = 0;
    float radius = 0;
};

/// Capsules that are united before they are painted in one colour, so that joints and crossings of a
/// see-through or smooth-edged line do not darken.
struct Layer {
    Color color;
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
};

/// One frame as plain data: layers painted in order over a background.
struct DrawList {
    int width = 0;
    int height = 0;
    Color background;  ///< opaque
    std::vector<Capsule> capsules;
    std::vector<Layer> layers;  ///< contiguous and in the order of `capsules`
    PixelRect bounds;           ///< holds every pixel that differs from the background; within the frame
};

/// How far outside `radius` a capsule can still touch a pixel: half a pixel of smooth edge, and slack for
/// rounding.
inline constexpr float kEdgeMargin = 2.0F;

/// Most layers that one frame may have: the renderer keeps a mask a layer.
inline constexpr std::size_t kMaxLayers = 64;

}  // namespace corda::view
