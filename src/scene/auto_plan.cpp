#include "corda/scene/auto_plan.hpp"

#include "corda/scene/player.hpp"

namespace corda::scene {
namespace {

/// How precisely the motion is known when the camera is fitted to tell the size of a pixel: far below a pixel
/// of any picture, and cheap.
constexpr double kFittingTolerance = 1e-6;

double pixels_per_metre(const Scene& scene) {
    Scene rehearsal = scene;
    rehearsal.solver.method = sim::Method::kExact;
    rehearsal.solver.tolerance = kFittingTolerance;
    return Player(rehearsal).camera().pixels_per_metre();
}

}  // namespace

std::optional<AutoPlan> settle_method(Scene& scene) {
    if (scene.solver.method != sim::Method::kAuto) return std::nullopt;
    AutoPlan result;
    result.pixels_per_metre = pixels_per_metre(scene);
    const sim::PlanDef def{scene.solver.tolerance_px / result.pixels_per_metre, scene.video.fps,
                           scene.video.fps.last_frame_within(scene.world.duration_s)};
    result.plan = sim::plan_solver(system_of(scene), scene.world, def);
    scene.solver = result.plan.solver;
    return result;
}

}  // namespace corda::scene
