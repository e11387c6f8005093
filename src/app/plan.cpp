#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/scene/player.hpp"

namespace corda::app {
namespace {

/// What the scene asks for and what it therefore costs nothing to leave out.
std::vector<std::string> list_terms(const scene::Scene& scene) {
    std::vector<std::string> terms;
    const bool relaxation = scene.solver.method == sim::Method::kRelaxation;
    if (relaxation && scene.solver.force_n) {
        terms.push_back(fmt::format("a force of ({}, {}) N on every particle, in place of gravity",
                                    scene.solver.force_n->x, scene.solver.force_n->y));
    } else if (scene.world.gravity_m_s2 == sim::Vec2{}) {
        terms.emplace_back("no gravity");
    } else {
        terms.push_back(
            fmt::format("gravity of ({}, {}) m/s2", scene.world.gravity_m_s2.x, scene.world.gravity_m_s2.y));
    }
    terms.push_back(scene.world.drag_1_s == 0.0
                        ? "no drag: energy is kept"
                        : fmt::format("linear drag of {} 1/s, exact", scene.world.drag_1_s));
    terms.emplace_back(relaxation ? "bars that stretch by what the passes leave"
                                  : "links that do not stretch");
    return terms;
}

std::string why(const scene::Scene& scene, const std::optional<scene::AutoPlan>& proof) {
    return proof ? proof->plan.reason
                 : fmt::format("the scene asks for {}", sim::method_name(scene.solver.method));
}

/// Steps from the start to the end, where they are known before the run: those of the plan's trial, or of a
/// literal step.
std::optional<double> expected_steps(const scene::Scene& scene, const std::optional<scene::AutoPlan>& proof) {
    if (proof && !proof->plan.trials.empty()) {
        return static_cast<double>(proof->plan.trials.back().steps);
    }
    const bool has_default = scene.solver.method == sim::Method::kRelaxation;
    if (!scene.solver.step_s && !has_default) return std::nullopt;
    return scene.world.duration_s / scene.solver.step_s.value_or(scene.video.fps.interval_s());
}

nlohmann::json to_json(const sim::Trial& trial) {
    return {{"solver", describe(trial.solver)},
            {"check", describe(trial.check)},
            {"steps", trial.steps},
            {"largest_difference_m", trial.largest_difference_m},
            {"reached_s", trial.reached_s},
            {"to_the_end", trial.to_the_end}};
}

ExitCode plan(const Console& console, const SceneOptions& options) {
    scene::Scene scene = options.load();
    const auto proof = settle_method(console, scene);
    const sim::System system = sim::build_system(scene.ropes, scene.solver.reach);
    const std::vector<std::string> terms = list_terms(scene);
    nlohmann::json json = {{"schema", 1},
                           {"method", sim::method_name(scene.solver.method)},
                           {"solver", describe(scene.solver)},
                           {"reason", why(scene, proof)},
                           {"terms", terms},
                           {"particles", system.particle_count()},
                           {"bars", system.bars.size()},
                           {"links", system.link_count()},
                           {"frames", scene::frame_count(scene)},
                           {"steps", nullptr},
                           {"cost_s", nullptr},
                           {"trials", nlohmann::json::array()}};
    report_proof(proof, json);
    console.result(fmt::format("{}: {}", scene.name, scene::describe(system)));
    for (const std::string& term : terms) console.result("modelled: " + term);
    console.result(fmt::format("solver: {}, because {}", describe(scene.solver), why(scene, proof)));
    if (proof) {
        for (const sim::Trial& trial : proof->plan.trials) {
            json["trials"].push_back(to_json(trial));
            console.result(fmt::format("tried: {} against {}: {} steps, differ by {:.2g} m up to {:.6g} s",
                                       describe(trial.solver), describe(trial.check), trial.steps,
                                       trial.largest_difference_m, trial.reached_s));
        }
    }
    if (proof && proof->plan.error_bound_m) {
        console.result(fmt::format("expected error: at most {:.2g} px, {:.2g} m", *proof->error_bound_px(),
                                   *proof->plan.error_bound_m));
    }
    if (const auto steps = expected_steps(scene, proof)) {
        const double cost_s = 1e-9 * *steps * sim::step_cost_ns(system, scene.solver);
        json["steps"] = std::llround(*steps);
        json["cost_s"] = cost_s;
        console.result(fmt::format("expected cost: {:.0f} steps of {} particles and {} bars, some {:.2g} s",
                                   *steps, system.particle_count(), system.bars.size(), cost_s));
    }
    console.report(json);
    return ExitCode::kOk;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
    auto options = std::make_shared<SceneOptions>();
    CLI::App* command =
        app.add_subcommand("plan", "say what will be modelled and why, which solver, its error and cost");
    options->add_to(*command);
    options->add_size(*command);
    options->add_shortcut(*command, "--fps", "video.fps", "frames a second");
    options->add_shortcut(*command, "--duration", "world.duration", "seconds");
    command->callback([options, &action] {
        action = [options](const Console& console) { return plan(console, *options); };
    });
}

}  // namespace corda::app
