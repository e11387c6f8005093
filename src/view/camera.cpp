#include "corda/view/camera.hpp"

#include <algorithm>
#include <cassert>

namespace corda::view {
namespace {

/// A scene whose motion has no extent is shown this many metres high.
constexpr double kSmallestViewMetres = 1e-6;

}  // namespace

void MotionBounds::include(const sim::State& state) {
    for (const double x : state.x_m) {
        min_.x = std::min(min_.x, x);
        max_.x = std::max(max_.x, x);
    }
    for (const double y : state.y_m) {
        min_.y = std::min(min_.y, y);
        max_.y = std::max(max_.y, y);
    }
}

bool Camera::needs_motion(const CameraDef& def) {
    return !def.center_m || !def.height_m;
}

Camera::Camera(const CameraDef& def, sim::Vec2 origin_m, const MotionBounds& bounds, int width, int height,
               double clearance_px)
    : half_width_px_(0.5 * width), half_height_px_(0.5 * height) {
    assert(!needs_motion(def) || !bounds.empty());
    center_ = def.center_m ? *def.center_m - origin_m : 0.5 * (bounds.min_m() + bounds.max_m());
    if (def.height_m) {
        pixels_per_metre_ = height / *def.height_m;
        return;
    }
    // Half extents about the centre, which a scene may have set off the motion's middle.
    const sim::Vec2 low = center_ - bounds.min_m();
    const sim::Vec2 high = bounds.max_m() - center_;
    const double half_x_m = std::max({low.x, high.x, 0.5 * kSmallestViewMetres});
    const double half_y_m = std::max({low.y, high.y, 0.5 * kSmallestViewMetres});
    const double border_px = def.margin * std::min(width, height) + clearance_px;
    // Thick lines in a tiny picture leave no room: then the motion still gets a tenth of it.
    const double room_x_px = std::max(0.1 * half_width_px_, half_width_px_ - border_px);
    const double room_y_px = std::max(0.1 * half_height_px_, half_height_px_ - border_px);
    pixels_per_metre_ = std::min(room_x_px / half_x_m, room_y_px / half_y_m);
}

}  // namespace corda::view
