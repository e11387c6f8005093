#include "corda/view/camera.hpp"

#include <algorithm>
#include <cassert>

namespace corda::view {
namespace {

/// The extent that is shown of a scene in which all particles stay in one place, in metres.
constexpr double kSmallestViewMetres = 1e-6;

}  // namespace

bool needs_motion(const CameraDef& def) {
    return !def.center_m || !def.height_m;
}

CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, const MotionBounds& bounds,
                     const PictureSize& size) {
    if (!needs_motion(def)) return def;
    assert(!bounds.empty());
    const Vec2 center = def.center_m ? *def.center_m - origin_m : 0.5 * (bounds.min_m() + bounds.max_m());
    CameraDef fitted = def;
    fitted.center_m = origin_m + center;
    if (def.height_m) return fitted;
    // Half extents about the centre, which need not be the middle of the motion.
    const Vec2 low = center - bounds.min_m();
    const Vec2 high = bounds.max_m() - center;
    const double half_x_m = std::max({low.x, high.x, 0.5 * kSmallestViewMetres});
    const double half_y_m = std::max({low.y, high.y, 0.5 * kSmallestViewMetres});
    const double half_width_px = 0.5 * size.width_px;
    const double half_height_px = 0.5 * size.height_px;
    const double border_px = def.margin * std::min(size.width_px, size.height_px) + size.clearance_px;
    // Thick lines may leave no room in a tiny picture; the motion always gets at least a tenth.
    const double room_x_px = std::max(0.1 * half_width_px, half_width_px - border_px);
    const double room_y_px = std::max(0.1 * half_height_px, half_height_px - border_px);
    fitted.height_m = size.height_px / std::min(room_x_px / half_x_m, room_y_px / half_y_m);
    return fitted;
}

Camera::Camera(const CameraDef& def, Vec2 origin_m, int width_px, int height_px)
    : center_(def.center_m.value() - origin_m),
      pixels_per_metre_(height_px / def.height_m.value()),
      half_width_px_(0.5 * width_px),
      half_height_px_(0.5 * height_px) {}

}  // namespace corda::view
