#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/rational.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/overlay.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::film {

struct Motion;

/// The paths of the particles that leave trails, at frame times: of a long trail, every few of them. A trail
/// has the same points whatever was drawn before.
struct Paths {
    std::vector<std::size_t> particles;
    double trail_s = 0.0;
    FrameRate fps;
    std::int64_t stride = 1;               ///< frames per point
    std::vector<view::TrailPoint> points;  ///< per time: one of each particle, without ages

    /// The trails that end at a state, one per particle.
    [[nodiscard]] std::vector<view::Trail> to(const State& state) const;
};

/// The camera, colours, arrows, supports, plots and trails of a scene with a motion. Made by
/// look_at(), and never changed afterwards.
struct Look {
    Scene scene;
    const System* system;
    view::SceneView view;
    view::Overlay overlay;
    CameraDef camera;  ///< with centre and height, of one that moves those without its path
    std::optional<view::CameraTrack> track = {};  ///< of a camera that moves
    Paths paths = {};
    double energy_zero_j = 0.0;  ///< potential energy since the start that texts show as 0

    /// The camera at a time, with centre and height, and its map to pixels.
    [[nodiscard]] CameraDef camera_at(double time_s) const;
    [[nodiscard]] view::Camera map_at(double time_s) const;
};

/// How a scene looks that moves like this. The motion must outlive it. Throws corda::Error (kInvalidScene)
/// for an invalid size, style or camera.
[[nodiscard]] Look look_at(const Scene& scene, const Motion& motion);

/// How a scene looks in which no particle moves out of its bounds: without plots, arrows and trails.
/// `system` must outlive the look.
[[nodiscard]] Look look_within(const Scene& scene, const System& system,
                               std::span<const MotionBounds> bounds);

/// The scale of pictures before there is a motion.
class PictureScale {
  public:
    /// The scene and the system must outlive it.
    PictureScale(const Scene& scene, const System& system);

    /// Lower bound on the displacement in pixels per metre of error of positions, by the camera that
    /// look_at() fits to a motion within `bounds`.
    [[nodiscard]] double largest_error_px_per_metre(const MotionBounds& bounds) const;

  private:
    const Scene* scene_;
    Vec2 origin_m_;
    view::Insets insets_;
};

}  // namespace corda::film
