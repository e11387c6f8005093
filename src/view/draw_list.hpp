#pragma once

#include <cstddef>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// A point in pixels, y down. It may lie outside the frame.
struct PixelPoint {
    double x = 0;
    double y = 0;
};

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
    /// Within this distance of the segment the ground shows in place of the layers below; 0: they stay.
    float halo_radius = 0;
};

/// Capsules of one colour. They are united before they are painted, so that the joints and crossings of a
/// transparent or smooth-edged line do not darken, and so are their halos.
struct Layer {
    Color color;
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
};

/// One frame as plain data: layers painted in order over a ground.
struct DrawList {
    int width = 0;
    int height = 0;
    Ground ground;
    std::vector<Capsule> capsules;
    std::vector<Layer> layers;  ///< contiguous and in the order of `capsules`
    PixelRect bounds;           ///< contains every pixel that differs from the ground; within the frame

    /// Whether all of it is outside of the frame, or there is nothing.
    [[nodiscard]] bool shows_nothing() const;
    /// Removes the layers, but keeps their memory.
    void clear();
    /// Adds an empty layer on top of the others.
    void add_layer(Color color);
    /// Adds the capsule around the segment from `a` to `b` to the last layer, if it can touch the frame. Its
    /// halo extends `halo_px` beyond `radius_px`.
    void add_capsule(PixelPoint a, PixelPoint b, double radius_px, double halo_px = 0.0);
    /// Adds a circle of that radius, drawn with a pen of `width_px`, as a polygon.
    void add_ring(PixelPoint center, double radius_px, double width_px);
};

/// How far beyond its radii a capsule can still touch a pixel, in pixels: half a pixel of smooth edge, and
/// slack for rounding.
inline constexpr float kEdgeMargin = 2.0F;

}  // namespace corda::view
