#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/scene/player.hpp"

namespace corda::app {
namespace {

/// The values above 0 of one figure of all bodies.
class Values {
  public:
    void include(double value) {
        if (value == 0.0) return;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }
    [[nodiscard]] bool empty() const { return high_ == 0.0; }
    [[nodiscard]] std::string text() const {
        return low_ == high_ ? fmt::format("{}", low_) : fmt::format("{} .. {}", low_, high_);
    }

  private:
    double low_ = HUGE_VAL;
    double high_ = 0.0;
};

/// What the bodies are made of.
struct Materials {
    Values compliance_1_n;
    Values bending_n_m2;
    bool rigid = false;
    bool slack = false;    ///< a string, of either kind
    bool plastic = false;  ///< a rigid string: energy is lost where it comes taut
};

Materials list_materials(const scene::Scene& scene) {
    Materials result;
    const auto include = [&result](const sim::MaterialDef& material) {
        const bool rigid = material.compliance_1_n == 0.0;
        result.compliance_1_n.include(material.compliance_1_n);
        result.rigid = result.rigid || rigid;
        result.slack = result.slack || material.is_string;
        result.plastic = result.plastic || (material.is_string && rigid);
    };
    for (const sim::RopeDef& rope : scene.ropes) {
        include(rope.material);
        result.bending_n_m2.include(rope.bending_n_m2);
    }
    for (const sim::NetDef& net : scene.nets) include(net.material);
    return result;
}

std::string force_term(const scene::Scene& scene) {
    if (scene.solver.method == sim::Method::kRelaxation && scene.solver.force_n) {
        return fmt::format("a force of ({}, {}) N on every particle, in place of gravity",
                           scene.solver.force_n->x, scene.solver.force_n->y);
    }
    const sim::Vec2 gravity_m_s2 = scene.world.gravity_m_s2;
    if (gravity_m_s2 == sim::Vec2{}) return "no gravity";
    return fmt::format("gravity of ({}, {}) m/s2", gravity_m_s2.x, gravity_m_s2.y);
}

std::string drag_term(const scene::Scene& scene, const Materials& materials) {
    if (scene.world.drag_1_s != 0.0) return fmt::format("linear drag of {} 1/s, exact", scene.world.drag_1_s);
    if (scene.solver.method == sim::Method::kRelaxation) {
        return scene.solver.delta > 0.0
                   ? fmt::format("damping: a share of {} of the velocity is lost a step", scene.solver.delta)
                   : "no drag; the passes lose energy, and print how much";
    }
    return materials.plastic ? "no drag: energy is lost only where a string comes taut"
                             : "no drag: energy is kept";
}

std::string nets_term(const scene::Scene& scene) {
    std::size_t real = 0;
    std::size_t all = 0;
    for (const sim::NetDef& net : scene.nets) {
        all += net.bars.size();
        real += static_cast<std::size_t>(std::count_if(net.bars.begin(), net.bars.end(),
                                                       [](const sim::NetBar& bar) { return bar.is_real; }));
    }
    return fmt::format("nets: {}, of {} bars and {} imaginary ones", scene.nets.size(), real, all - real);
}

/// What the scene asks for and what it therefore costs nothing to leave out.
std::vector<std::string> list_terms(const scene::Scene& scene) {
    const Materials materials = list_materials(scene);
    std::vector<std::string> terms{force_term(scene), drag_term(scene, materials)};
    if (scene.solver.method == sim::Method::kRelaxation) {
        terms.emplace_back("bars that stretch by what the passes leave");
    } else if (materials.rigid) {
        terms.emplace_back("links that do not stretch");
    }
    if (!materials.compliance_1_n.empty()) {
        terms.push_back(fmt::format("links that stretch by {} of their length a newton",
                                    materials.compliance_1_n.text()));
    }
    if (materials.slack) terms.emplace_back("strings: links that pull and never push");
    if (!materials.bending_n_m2.empty())
        terms.push_back(fmt::format("bending stiffness of {} N m2", materials.bending_n_m2.text()));
    const auto closed = std::count_if(scene.ropes.begin(), scene.ropes.end(),
                                      [](const sim::RopeDef& rope) { return rope.closed; });
    if (closed > 0) terms.push_back(fmt::format("closed ropes: {}", closed));
    if (!scene.nets.empty()) terms.push_back(nets_term(scene));
    return terms;
}

std::string why(const scene::Scene& scene, const std::optional<scene::AutoPlan>& proof) {
    return proof ? proof->plan.reason
                 : fmt::format("the scene asks for {}", sim::method_name(scene.solver.method));
}

/// Steps from the start to the end, where they are known before the run: those of the plan's trial, or of a
/// literal step.
std::optional<double> expected_steps(const scene::Scene& scene, const std::optional<scene::AutoPlan>& proof) {
    if (proof && proof->plan.error_bound_m) {
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
    const sim::System system = scene::system_of(scene);
    // What would refuse to run has no plan.
    static_cast<void>(scene::Run(scene));
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
