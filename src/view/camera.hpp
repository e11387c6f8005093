#pragma once

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// An axis-aligned box in metres, relative to the system's origin. Starts empty.
class MotionBounds {
  public:
    void include(const sim::State& state);
    [[nodiscard]] bool empty() const { return max_.x < min_.x; }
    [[nodiscard]] sim::Vec2 min_m() const { return min_; }
    [[nodiscard]] sim::Vec2 max_m() const { return max_; }

  private:
    sim::Vec2 min_{1e300, 1e300};
    sim::Vec2 max_{-1e300, -1e300};
};

/// The map from metres (relative to the system's origin, y up) to pixels (y down).
class Camera {
  public:
    /// True where `def` leaves something to the motion, so that its bounds are needed.
    [[nodiscard]] static bool needs_motion(const CameraDef& def);

    /// Fits `bounds` (ignored where `def` says it all) into `width` x `height` pixels with `clearance_px`
    /// around for the width of what is drawn. `origin_m` is the system's.
    Camera(const CameraDef& def, sim::Vec2 origin_m, const MotionBounds& bounds, int width, int height,
           double clearance_px);

    [[nodiscard]] double x_px(double x_m) const {
        return half_width_px_ + (x_m - center_.x) * pixels_per_metre_;
    }
    [[nodiscard]] double y_px(double y_m) const {
        return half_height_px_ - (y_m - center_.y) * pixels_per_metre_;
    }
    [[nodiscard]] double pixels_per_metre() const { return pixels_per_metre_; }

  private:
    sim::Vec2 center_;
    double pixels_per_metre_ = 1.0;
    double half_width_px_ = 0.0;
    double half_height_px_ = 0.0;
};

}  // namespace corda::view
