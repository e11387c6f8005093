#pragma once

#include <optional>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// A point of the picture in pixels, y down; may lie outside of the frame.
struct PixelPoint {
    double x = 0;
    double y = 0;
};

/// The capsule of `radius_px` around the segment from `a` to `b`, or nothing where it cannot touch a frame of
/// `width` x `height` pixels. A segment that leaves the frame is cut outside of what can be seen, so that no
/// number is too large for float.
[[nodiscard]] std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width,
                                                  int height);

/// The pixels of the frame that a capsule may touch.
[[nodiscard]] PixelRect capsule_bounds(const Capsule& capsule, int width, int height);

}  // namespace corda::view
