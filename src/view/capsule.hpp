#pragma once

#include <optional>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// The capsule of `radius_px`, with a halo of `halo_px` more, around the segment from `a` to `b`;
/// std::nullopt if it cannot touch a frame of `width` x `height` pixels, or if a coordinate is not a number.
/// A segment that leaves the frame is cut beyond the visible part, so that every coordinate fits into a
/// float; points farther than 1e30 pixels away count as that far.
[[nodiscard]] std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width,
                                                  int height, double halo_px = 0.0);

/// The upright box around all that is within `extent` of the capsule's segment, in pixels.
struct Surroundings {
    float x0;
    float y0;
    float x1;
    float y1;
};
[[nodiscard]] Surroundings surroundings(const Capsule& capsule, float extent);

/// The part of the frame that the capsule may touch.
[[nodiscard]] PixelRect capsule_bounds(const Capsule& capsule, int width, int height);

}  // namespace corda::view
