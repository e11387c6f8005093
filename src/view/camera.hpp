#pragma once

#include <span>

#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// Extent of one drawn item: the bounds of its points during the motion, and its size around each point.
struct Drawn {
    MotionBounds bounds;
    // Extent around each point.
    double left_px = 0.0;
    double right_px = 0.0;
    double up_px = 0.0;
    double down_px = 0.0;
};

/// Minimum free space at the upper and lower edges, and the space that panels take. The camera's margin
/// applies to panels too.
struct Insets {
    double top_px = 0.0;
    double bottom_px = 0.0;
    double right_panel_px = 0.0;
    double bottom_panel_px = 0.0;
};

/// True if the centre or the height is not given, so that it follows from the motion.
[[nodiscard]] bool needs_motion(const CameraDef& def);

/// Returns `def` with centre and height filled in so that everything drawn fits into a picture of this size,
/// in the middle of the space that `insets` leave. Keeps the fields that `def` gives. `origin_m` is the
/// system's. If needs_motion(def), `drawn` must not be empty.
[[nodiscard]] CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, std::span<const Drawn> drawn,
                                   int width_px, int height_px, const Insets& insets = {});

/// The map from metres (relative to the system's origin, y up) to pixels (y down).
class Camera {
  public:
    /// `def` must give centre and height. `origin_m` is the system's.
    Camera(const CameraDef& def, Vec2 origin_m, int width_px, int height_px);

    [[nodiscard]] double x_px(double x_m) const {
        return half_width_px_ + (x_m - center_.x) * pixels_per_metre_;
    }
    [[nodiscard]] double y_px(double y_m) const {
        return half_height_px_ - (y_m - center_.y) * pixels_per_metre_;
    }
    [[nodiscard]] double pixels_per_metre() const { return pixels_per_metre_; }

  private:
    Vec2 center_;  ///< relative to the system's origin
    double pixels_per_metre_;
    double half_width_px_;
    double half_height_px_;
};

}  // namespace corda::view
