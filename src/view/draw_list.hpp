#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::view {

/// A line with round caps: all points within `radius` of a segment. A disc if `length` is 0.
///
/// In pixels, x to the right, y down; the centre of the top left pixel is at (0.5, 0.5). (ax, ay) is the
/// start of the segment, a multiple of 1/1024, so that differences to pixel centres are exact in float. (ux,
/// uy) is its unit direction, rounded once from double.
struct Capsule {
    float ax = 0;
    float ay = 0;
    float ux = 1;
    float uy = 0;
    float length = 0;
    float radius = 0;
};

/// Capsules of one colour. They are united before they are painted, so that the joints and crossings of a
/// transparent or smooth-edged line do not darken.
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
    PixelRect bounds;           ///< contains every pixel that differs from the background; within the frame
};

/// How far beyond `radius` a capsule can still touch a pixel, in pixels: half a pixel of smooth edge, and
/// slack for rounding.
inline constexpr float kEdgeMargin = 2.0F;

/// The most layers that a frame may have. The renderer keeps one mask per layer.
inline constexpr std::size_t kMaxLayers = 64;

}  // namespace corda::view
