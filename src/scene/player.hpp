#pragma once

#include <cstdint>
#include <string>

#include "corda/scene/scene.hpp"
#include "corda/sim/frame_watch.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::scene {

/// Runs a scene's simulation to exact times and keeps its figures.
class Run {
  public:
    /// Throws corda::Error (kInvalidScene) where the method cannot run the scene.
    explicit Run(const Scene& scene, sim::Figured figured = sim::Figured::kYes);

    /// Goes on to `time_s`, not before the last time.
    sim::Status go(double time_s);

    /// The state at `time_s`, not before the last one. Throws corda::Error (kDiverged), naming the time.
    const sim::State& at(double time_s);

    [[nodiscard]] const sim::Simulation& simulation() const { return simulation_; }
    /// Seconds spent in the stepping alone.
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    sim::Simulation simulation_;
    double wall_s_ = 0.0;
};

/// A scene as draw lists: the camera is fitted to the whole motion first, so that a frame looks the same
/// whichever others are drawn.
class Player {
  public:
    /// `watch`: of the run that a camera is fitted to, where it follows the motion. Throws corda::Error
    /// (kInvalidScene), and what `watch` throws. A motion that diverges is shown as far as it goes.
    explicit Player(const Scene& scene, const sim::FrameWatch& watch = {});

    /// The frame at `time_s`, not before the last one. Throws corda::Error (kDiverged).
    const view::DrawList& at(double time_s);

    [[nodiscard]] const Run& run() const { return run_; }
    [[nodiscard]] const view::Camera& camera() const { return camera_; }

  private:
    Run run_;
    view::SceneView view_;
    view::Camera camera_;
    view::DrawList list_;
};

/// "40 particles, 252 bars (39 links)": what a scene amounts to.
[[nodiscard]] std::string describe(const sim::System& system);

/// Number of images of the scene's video.
[[nodiscard]] std::int64_t frame_count(const Scene& scene);

}  // namespace corda::scene
