#pragma once

#include <array>
#include <cstddef>

#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Points of a curve.
struct Arc {
    static constexpr std::size_t kMaxPoints = 49;
    std::array<PixelPoint, kMaxPoints> points;
    std::size_t count = 0;
};

/// The shape of a slack line of `length_px` between two points that are closer than that: an arc that hangs
/// towards `down`, a unit vector. The parabola a + t (b - a) + 4 t (1 - t) s down, 0 <= t <= 1, as equal
/// steps in t, with the sag s that gives these steps the length. It is symmetric, and it moves steadily if
/// the ends do: for ends one above the other it is folded. The points include `a` and `b`.
[[nodiscard]] Arc hang_slack(PixelPoint a, PixelPoint b, double length_px, PixelPoint down);

}  // namespace corda::view
