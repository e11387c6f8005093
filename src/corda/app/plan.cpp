#include <cmath>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/sim/solver.hpp"

namespace corda::app {
namespace {

struct PlanOptions {
    SceneOptions scene;
    bool toml = false;
};

/// Steps of one run: those of the trial that holds, or the duration over the step; std::nullopt if only a run
/// can show them.
std::optional<std::uint64_t> steps_of(const Film& film) {
    std::uint64_t steps = 0;
    for (const BodyPlan& body : film.plan().bodies) {
        if (body.error_estimate_m)
            steps += body.trials.back().steps;
        else if (const std::optional<double> step_s = sim::fixed_step_s(body.method))
            steps += static_cast<std::uint64_t>(std::llround(film.scene().world.duration_s / *step_s));
        else
            return std::nullopt;
    }
    return steps;
}

nlohmann::json to_json(const Trial& trial) {
    return {{"solver", sim::method_text(trial.method)},
            {"check", sim::method_text(trial.check)},
            {"steps", trial.steps},
            {"largest_difference_m", trial.largest_difference_m},
            {"reached_s", trial.reached_s},
            {"to_the_end", trial.to_the_end}};
}

nlohmann::json to_json(const Film& film, std::size_t i) {
    const BodyPlan& body = film.plan().bodies[i];
    nlohmann::json json = {{"body", body_name(film.system(), i)},
                           {"method", method_name(body)},
                           {"solver", method_text(body)},
                           {"reason", reason_text(body)},
                           {"error_estimate_m", or_null(body.error_estimate_m)},
                           {"horizon_s", or_null(body.horizon_s)},
                           {"horizon_reason", or_null(horizon_reason(body))},
                           {"trials", nlohmann::json::array()}};
    for (const Trial& trial : body.trials) json["trials"].push_back(to_json(trial));
    return json;
}

/// The methods, each with the trials for the first of its bodies.
void report_methods(const Console& console, const Film& film) {
    const std::vector<MethodGroup> groups = groups_of(film.plan());
    const bool is_one = film.plan().bodies.size() == 1;
    for (const MethodGroup& group : groups) {
        const BodyPlan& body = film.plan().bodies[group.bodies.front()];
        const std::string whose = groups.size() == 1 ? "" : " of " + bodies_text(film.system(), group.bodies);
        console.result(fmt::format("solver{}: {}, because {}", whose, method_text(body), reason_text(body)));
        const std::string whom =
            is_one ? "" : fmt::format(" for {}", body_name(film.system(), group.bodies.front()));
        for (const Trial& trial : body.trials) {
            const std::string differ = trial.to_the_end || trial.reached_s > 0.0
                                           ? fmt::format("differ by {:.2g} m up to {:.6g} s",
                                                         trial.largest_difference_m, trial.reached_s)
                                           : "differ too much from the start";
            console.result(fmt::format("tried{}: {} against {}: {} steps, {}", whom,
                                       sim::method_text(trial.method), sim::method_text(trial.check),
                                       trial.steps, differ));
        }
    }
}

void report_in_words(const Console& console, const Film& film, const std::vector<std::string>& terms) {
    console.result(fmt::format("{}: {}", film.scene().name, system_text(film.system())));
    for (const std::string& term : terms) console.result("modelled: " + term);
    report_methods(console, film);
    const Plan& plan = film.plan();
    if (const auto estimate = error_estimate_text(film))
        console.result("error estimate: " + *estimate);
    else if (plan.horizon_s == 0.0)
        console.result("error estimate: none; the motion cannot be predicted from the start");
    else if (film.scene().given)
        console.result("error estimate: none; the positions are those of " + film.scene().given->source());
    else
        console.result("error estimate: none; method auto tries tighter runs and tells how far they differ");
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const auto reason = horizon_reason(plan.bodies[i]);
        if (!reason) continue;
        const std::string whose = plan.bodies.size() == 1 ? "" : " of " + body_name(film.system(), i);
        console.result(fmt::format(
            "horizon{}: {:.6g} s; after that {}, because {}", whose, *plan.bodies[i].horizon_s,
            plan.bodies[i].unchecked ? "no error is known" : "the motion cannot be predicted", *reason));
    }
}

ExitCode plan(const Console& console, const PlanOptions& options) {
    const Film film = make_film(console, load(console, options.scene).scene, {}, "plan");
    const CameraDef& camera = film.camera();
    if (options.toml) {
        std::string toml = frozen_toml(film);
        if (const auto estimate = error_estimate_text(film))
            toml.insert(0, fmt::format("# error estimate by method auto: {}\n", *estimate));
        console.result(toml);
        console.report({{"schema", 1}, {"toml", toml}});
        return ExitCode::kOk;
    }
    const std::vector<std::string> terms = modelled_terms(film.scene(), film.plan());
    report_in_words(console, film, terms);
    console.result(fmt::format("camera: center ({:.6g}, {:.6g}) m, {:.6g} m high", camera.center_m->x,
                               camera.center_m->y, *camera.height_m));
    nlohmann::json json = film_json(film);
    json["terms"] = terms;
    json["frames"] = film.frame_count();
    const std::optional<std::uint64_t> steps = steps_of(film);
    json["steps"] = steps ? nlohmann::json(*steps) : nlohmann::json();
    if (steps) console.result(fmt::format("expected steps: {}", *steps));
    json["bodies"] = nlohmann::json::array();
    for (std::size_t i = 0; i < film.plan().bodies.size(); ++i) json["bodies"].push_back(to_json(film, i));
    console.report(json);
    return ExitCode::kOk;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "plan", "show the model, the method and the reason for it, and its error", plan);
    add_scene(command, options.scene);
    add_positions(command, options.scene);
    add_size(command, options.scene);
    add_timing(command, options.scene);
    command.add_flag("--toml", options.toml,
                     "print [solver] and [camera] as they were chosen; in place of the scene's own, "
                     "they freeze it");
}

}  // namespace corda::app
