#include "corda/scene/auto_plan.hpp"

#include "corda/scene/naming_file.hpp"
#include "corda/scene/player.hpp"

namespace corda::scene {
namespace {

double pixels_per_metre(const Scene& scene, const sim::System& system, const sim::FrameWatch& watch) {
    Scene rehearsal = scene;
    rehearsal.solver = sim::scouting_solver(system, scene.world, scene.video.fps.interval_s());
    return Player(rehearsal, watch).camera().pixels_per_metre();
}

}  // namespace

std::optional<AutoPlan> settle_method(Scene& scene, const sim::FrameWatch& watch) {
    if (scene.solver.method != sim::Method::kAuto) return std::nullopt;
    const sim::System system = system_of(scene);
    AutoPlan result;
    result.pixels_per_metre = naming_file(scene, [&] { return pixels_per_metre(scene, system, watch); });
    const sim::PlanDef def{scene.solver.tolerance_px / result.pixels_per_metre, scene.video.fps,
                           scene.video.fps.last_frame_within(scene.world.duration_s), watch};
    result.plan = naming_file(scene, [&] { return sim::plan_solver(system, scene.world, def); });
    scene.solver = result.plan.solver;
    return result;
}

}  // namespace corda::scene
