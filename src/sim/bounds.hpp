#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda {

/// The smallest upright box that contains all positions of a motion, in metres relative to the system's
/// origin. Empty at first.
class MotionBounds {
  public:
    void include(double x_m, double y_m) {
        min_ = {std::min(min_.x, x_m), std::min(min_.y, y_m)};
        max_ = {std::max(max_.x, x_m), std::max(max_.y, y_m)};
    }
    void include(const State& state) {
        for (std::size_t i = 0; i < state.x_m.size(); ++i) include(state.x_m[i], state.y_m[i]);
    }
    void include(const MotionBounds& other) {
        min_ = {std::min(min_.x, other.min_.x), std::min(min_.y, other.min_.y)};
        max_ = {std::max(max_.x, other.max_.x), std::max(max_.y, other.max_.y)};
    }
    [[nodiscard]] bool empty() const { return max_.x < min_.x; }
    [[nodiscard]] Vec2 min_m() const { return min_; }
    [[nodiscard]] Vec2 max_m() const { return max_; }

  private:
    Vec2 min_{1e300, 1e300};
    Vec2 max_{-1e300, -1e300};
};

/// Where each particle is at the start.
[[nodiscard]] inline std::vector<MotionBounds> bounds_of_start(const System& system) {
    std::vector<MotionBounds> bounds(system.particle_count());
    for (std::size_t i = 0; i < bounds.size(); ++i) bounds[i].include(system.x_m[i], system.y_m[i]);
    return bounds;
}

}  // namespace corda
