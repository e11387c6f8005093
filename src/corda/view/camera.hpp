#pragma once

#include <span>
#include <vector>

#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

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

/// The smallest height of a camera's path; `height_m` for keys without one.
[[nodiscard]] double least_height_m(const CameraDef& def, double height_m);

/// The errors of positions that add up in a picture: a camera that follows something errs with it, in the
/// worst case the other way.
[[nodiscard]] double errors_shown(const CameraDef& def);

/// The largest displacement in a picture of `height_px`, in pixels, by errors of positions of `error_m`. The
/// camera shows `height_m` where its path gives no height.
[[nodiscard]] double error_px(const CameraDef& def, double error_m, double height_m, int height_px);

/// Returns `def` with centre and height filled in so that everything drawn fits into a picture of this size,
/// in the middle of the space that `insets` leave. Keeps the fields that `def` gives. `origin_m` is the
/// system's. If one is missing, `drawn` must not be empty.
[[nodiscard]] CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, std::span<const Drawn> drawn,
                                   int width_px, int height_px, const Insets& insets = {});

/// The path of a moving camera: a monotone cubic through its keys in each coordinate, at rest at both ends
/// (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984)).
class CameraTrack {
  public:
    struct Key {
        double time_s = 0.0;
        Vec2 center_m;
        double height_m = 0.0;
    };
    /// At least one key, in order of time.
    explicit CameraTrack(std::vector<Key> keys);

    /// `def` with centre and height at a time; before the first key those of the first, after the last those
    /// of the last.
    [[nodiscard]] CameraDef at(const CameraDef& def, double time_s) const;

  private:
    std::vector<Key> keys_;
    std::vector<Key> slopes_;  ///< per second, at the keys
};

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
    /// The place of a particle.
    [[nodiscard]] PixelPoint at(const State& state, std::size_t particle) const {
        return {x_px(state.x_m[particle]), y_px(state.y_m[particle])};
    }
    [[nodiscard]] double pixels_per_metre() const { return pixels_per_metre_; }

  private:
    Vec2 center_;  ///< relative to the system's origin
    double pixels_per_metre_;
    double half_width_px_;
    double half_height_px_;
};

}  // namespace corda::view
