#pragma once

#include <optional>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// A point in pixels, y down. It may lie outside the frame.
struct PixelPoint {
    double x = 0;
    double y = 0;
};

/// The capsule of `radius_px` around the segment from `a` to `b`; std::nullopt if it cannot touch a frame of
/// `width` x `height` pixels, or if a coordinate is not a number. A segment that leaves the frame is cut
/// beyond the visible part, so that every coordinate fits into a float; points farther than 1e30 pixels away
/// count as that far.
[[nodiscard]] std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width,
                                                  int height);

/// The part of the frame that the capsule may touch.
[[nodiscard]] PixelRect capsule_bounds(const Capsule& capsule, int width, int height);

}  // namespace corda::view
