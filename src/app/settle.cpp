#include <memory>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "interrupt.hpp"

namespace corda::app {

std::string describe(const sim::SolverDef& solver) {
    std::string name(sim::method_name(solver.method));
    switch (solver.method) {
        case sim::Method::kAuto:
            return fmt::format("{} within {} px", name, solver.tolerance_px);
        case sim::Method::kRelaxation:
            return fmt::format("{} with reach {}, {} sweeps", name, solver.reach, solver.sweeps);
        case sim::Method::kRope:
            return fmt::format("{} of order {}", name, solver.order) +
                   (solver.step_s ? fmt::format(", step {} s", *solver.step_s) : std::string());
        case sim::Method::kExact:
            return fmt::format("{} at tolerance {:.3g}", name, solver.tolerance);
    }
    return name;
}

sim::FrameWatch preparation(const Console& console, const std::string& what) {
    constexpr double kSilentSeconds = 1.0;
    const double start_s = now_s();
    return [&console, what, start_s, progress = std::shared_ptr<Progress>()](
               std::int64_t frame, std::int64_t last_frame) mutable {
        if (interruption() != ExitCode::kOk) throw Error(interruption(), "interrupted; nothing was written");
        if (frame == 0 || !progress) progress = std::make_shared<Progress>(console, what, last_frame);
        if (now_s() - start_s > kSilentSeconds) progress->update(frame);
    };
}

std::optional<scene::AutoPlan> settle_method(const Console& console, scene::Scene& scene) {
    const double tolerance_px = scene.solver.tolerance_px;
    auto proof = scene::settle_method(scene, preparation(console, "plan"));
    if (!proof) return proof;
    const sim::Plan& plan = proof->plan;
    if (!plan.error_bound_m) {
        console.warning(fmt::format("auto: {}: {}", describe(scene.solver), plan.reason));
        return proof;
    }
    console.info(fmt::format("auto: {}; displayed error at most {:.2g} px ({:.2g} m), shown by a tighter run",
                             describe(scene.solver), *proof->error_bound_px(), *plan.error_bound_m));
    if (!plan.horizon_s) return proof;
    if (plan.diverges) {
        console.warning(fmt::format(
            "the simulation diverges after {:.6g} s; less speed, force or drag may help", *plan.horizon_s));
    } else {
        console.warning(fmt::format(
            "predictability ends at {:.6g} s: from there two runs of the highest precision differ "
            "by more than {:g} px, because the motion magnifies the least differences; what is "
            "drawn after it is one possible motion",
            *plan.horizon_s, tolerance_px));
    }
    return proof;
}

void report_proof(const std::optional<scene::AutoPlan>& proof, nlohmann::json& json) {
    json["error_bound_m"] = nullptr;
    json["error_bound_px"] = nullptr;
    json["horizon_s"] = nullptr;
    if (!proof || !proof->plan.error_bound_m) return;
    json["error_bound_m"] = *proof->plan.error_bound_m;
    json["error_bound_px"] = *proof->error_bound_px();
    if (proof->plan.horizon_s) json["horizon_s"] = *proof->plan.horizon_s;
}

}  // namespace corda::app
