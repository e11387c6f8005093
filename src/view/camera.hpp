#pragma once

#include <span>

#include "corda/sim/bounds.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// Something that is drawn around a point, or around several, and where these go during the motion.
struct Drawn {
    MotionBounds bounds;
    // How far it extends around each point.
    double left_px = 0.0;
    double right_px = 0.0;
    double up_px = 0.0;
    double down_px = 0.0;
};

/// What is to stay free at the upper and the lower edge, at least; and what panels take from the frame, at
/// whose edges is a border, too.
struct Insets {
    double top_px = 0.0;
    double bottom_px = 0.0;
    double right_panel_px = 0.0;
    double bottom_panel_px = 0.0;
};

/// Whether `def` leaves the centre or the height open, so that they follow from the motion.
[[nodiscard]] bool needs_motion(const CameraDef& def);

/// Returns `def` with centre and height filled in, such that all that is drawn is in a picture of this size,
/// and in the middle of what `insets` leave of it. What `def` gives is kept. `origin_m` is that of the
/// system. If needs_motion(def), something must be drawn.
[[nodiscard]] CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, std::span<const Drawn> drawn,
                                   int width_px, int height_px, const Insets& insets = {});

/// The map from metres (relative to the system's origin, y up) to pixels (y down).
class Camera {
  public:
    /// `def` must give centre and height. `origin_m` is that of the system.
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
