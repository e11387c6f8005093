#include "corda/scene/player.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "corda/core/error.hpp"
#include "corda/scene/naming_file.hpp"

namespace corda::scene {
namespace {

view::Camera fit_camera(const Scene& scene, const sim::System& system, double clearance_px,
                        const sim::FrameWatch& watch) {
    view::MotionBounds bounds;
    if (view::Camera::needs_motion(scene.camera)) {
        Run rehearsal(scene, sim::Figured::kNo);
        const std::int64_t last = scene.video.fps.last_frame_within(scene.world.duration_s);
        for (std::int64_t k = 0; k <= last; ++k) {
            if (watch) watch(k, last);
            if (rehearsal.go(scene.video.fps.time_s(k)) == sim::Status::kDiverged) break;
            bounds.include(rehearsal.simulation().state());
        }
        // The start is there even where the first step diverges.
        if (bounds.empty()) bounds.include(rehearsal.simulation().state());
    }
    return {scene.camera, system.origin_m, bounds, scene.video.width_px, scene.video.height_px, clearance_px};
}

}  // namespace

Run::Run(const Scene& scene, sim::Figured figured)
    : simulation_(naming_file(scene, [&] {
          return sim::Simulation(system_of(scene), scene.world, scene.solver, scene.video.fps.interval_s(),
                                 figured);
      })) {}

sim::Status Run::go(double time_s) {
    const auto start = std::chrono::steady_clock::now();
    const sim::Status status = simulation_.advance_to(time_s);
    wall_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return status;
}

const sim::State& Run::at(double time_s) {
    if (go(time_s) == sim::Status::kDiverged) {
        throw Error(ExitCode::kDiverged,
                    fmt::format("the simulation diverged before t = {:.6g} s (last good state at {:.6g} s); "
                                "less speed or force "
                                "may help, and with rope or relaxation a smaller solver.step",
                                time_s, simulation_.state().time_s));
    }
    return simulation_.state();
}

Player::Player(const Scene& scene, const sim::FrameWatch& watch)
    : run_(scene),
      view_(run_.simulation().system(), scene.style, scene.body_styles, scene.video.width_px,
            scene.video.height_px),
      camera_(fit_camera(scene, run_.simulation().system(), view_.clearance_px(), watch)) {}

const view::DrawList& Player::at(double time_s) {
    view_.draw(run_.at(time_s), camera_, list_);
    return list_;
}

std::string describe(const sim::System& system) {
    const auto nets = std::count_if(system.bodies.begin(), system.bodies.end(),
                                    [](const sim::Body& body) { return body.is_net; });
    const std::string what = nets == 0 ? "" : fmt::format("{} net{}: ", nets, nets == 1 ? "" : "s");
    return what + fmt::format("{} particles, {} bars ({} links)", system.particle_count(), system.bars.size(),
                              system.link_count());
}

std::int64_t frame_count(const Scene& scene) {
    return scene.video.fps.frame_count(scene.world.duration_s);
}

}  // namespace corda::scene
