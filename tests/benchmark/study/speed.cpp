#include "benchmark/study/speed.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "benchmark/study/chapters.hpp"
#include "benchmark/study/problems.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/solver.hpp"

namespace corda::study {
namespace {

std::vector<Problem> problems_of(const Options& options) {
    if (options.scene) return {problem_of(*options.scene)};
    return {report_swing(), a01_pendulum(), released_chain(), spinning_chain()};
}

nlohmann::json run_json(const Measurement& run, int reach) {
    nlohmann::json result{{"series", run.label}, {"parameter", run.parameter}, {"reach", reach}};
    if (!run.failure.empty()) {
        result["failure"] = run.failure;
        return result;
    }
    const Times& ms = run.ms_per_simulated_s;
    result["error_largest_over_length"] = run.largest_error;  // NaN, if not compared, becomes null
    result["error_rms_over_length"] = run.rms_error;
    result["strain_largest"] = run.largest_strain;
    result["energy_error_over_mgl"] = json_of(run.energy_error);
    result["ms_per_simulated_s"] = ms.median();
    result["ms_least"] = ms.least();
    result["ms_largest"] = ms.largest();
    result["steps"] = run.steps;
    return result;
}

/// The problem by all methods over their parameters.
nlohmann::json measure_problem(Problem problem, const Options& options, const OnRun& on_run) {
    Subject subject;
    subject.problem = std::move(problem);
    const std::string id = subject.problem.id;
    if (!subject.problem.reference) {
        on_run(id + ": truth");
        find_truth(subject);
    }
    nlohmann::json runs = nlohmann::json::array();
    for (const SweepRun& run : sweep_runs(subject.problem, options.quick)) {
        on_run(fmt::format("{}: {}, {:.3g}", id, run.label, run.parameter));
        const Problem compared = with_reach(facing(subject, run.method), run.reach);
        runs.push_back(
            run_json(measure(compared, run.method, run.label, run.parameter, options.timing()), run.reach));
    }
    return {{"id", id},
            {"title", subject.problem.title},
            {"truth", subject.problem.truth},
            {"truth_of_exact", subject.exact_reference ? nlohmann::json(subject.exact_truth) : nullptr},
            {"disagreement_over_length", json_of(subject.disagreement)},
            {"horizon_s", json_of(subject.horizon_s)},
            {"horizon_difference_over_length", kHorizonDifference},
            {"runs", std::move(runs)}};
}

constexpr int kMaxHalvings = 8;

/// Updates of bars or particles in a run; one of more is left out.
double most_updates(bool is_quick) {
    return is_quick ? 4e5 : 1e7;
}

double updates_of(const System& system, double duration_s, const MethodDef& method, double step_s) {
    const auto* const relaxation = std::get_if<RelaxationDef>(&method);
    const auto* const rattle = std::get_if<RattleDef>(&method);
    const std::size_t per_step =
        relaxation != nullptr ? system.bars.size() * static_cast<std::size_t>(relaxation->sweeps)
                              : system.particle_count() * sim::composition(rattle->order).stages.size();
    return static_cast<double>(per_step) * duration_s / step_s;
}

void add_relaxation(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    constexpr double kMaxStepSeconds = 1.0 / 60.0;
    const double frame_s = problem.fps.interval_s();
    const double longest_step_s = frame_s / std::ceil(frame_s / kMaxStepSeconds - 1e-9);
    const std::size_t bars = problem.system().bars.size();
    for (const int reach : {1, 7}) {
        const Problem reaching = with_reach(problem, reach);
        const System system = reaching.system();
        const bool has_imaginary_bars = system.bars.size() > bars;
        if (reach > 1 && !has_imaginary_bars) continue;
        const bool is_refused = !refusal(reaching, RelaxationDef{longest_step_s}).empty();
        for (const int sweeps : {1, 4, 16, 64}) {
            const std::string label = fmt::format("relaxation, reach {}, sweeps {}", reach, sweeps);
            for (int halving = 0; halving <= kMaxHalvings; halving += is_quick ? 2 : 1) {
                const double step_s = std::ldexp(longest_step_s, -halving);
                const MethodDef method = RelaxationDef{step_s, sweeps};
                const double updates = updates_of(system, problem.world.duration_s, method, step_s);
                if (halving > 0 && (is_refused || updates > most_updates(is_quick))) break;
                runs.push_back({method, label, step_s, reach});
            }
        }
    }
}

void add_rattle(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, RattleDef{2}).empty();
    const System system = problem.system();
    const double frame_s = problem.fps.interval_s();
    for (const int order : {2, 4, 6, 8}) {
        const std::string label = fmt::format("rattle, order {}", order);
        if (is_refused) {
            runs.push_back({RattleDef{order}, label, frame_s});
            continue;
        }
        const double steps_per_frame = std::round(frame_s / rattle_step_s(problem, order));
        // High orders reach rounding after a few halvings: they take two points per halving.
        const bool is_high = order >= 6;
        const int points_per_halving = is_high && !is_quick ? 2 : 1;
        const int last_point = points_per_halving * (is_high ? 2 : kMaxHalvings);
        for (int point = 0; point <= last_point; ++point) {
            const double finer = std::exp2(static_cast<double>(point) / points_per_halving);
            const double step_s = frame_s / std::round(steps_per_frame * finer);
            const MethodDef method = RattleDef{order, step_s};
            const double updates = updates_of(system, problem.world.duration_s, method, step_s);
            if (point > 0 && updates > most_updates(is_quick)) break;
            runs.push_back({method, label, step_s});
        }
    }
}

void add_exact(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, ExactDef{}).empty();
    for (int digits = 2; digits <= 13; digits += is_quick ? 2 : 1) {
        const double tolerance = std::stod(fmt::format("1e-{}", digits));
        runs.push_back({ExactDef{tolerance}, "exact", tolerance});
        if (is_refused) break;
    }
}

}  // namespace

nlohmann::json measure_speed(const Options& options, const OnRun& on_run) {
    nlohmann::json problems = nlohmann::json::array();
    for (Problem& problem : problems_of(options))
        problems.push_back(measure_problem(std::move(problem), options, on_run));
    return {{"problems", std::move(problems)}};
}

std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick) {
    std::vector<SweepRun> runs;
    add_relaxation(problem, is_quick, runs);
    add_rattle(problem, is_quick, runs);
    add_exact(problem, is_quick, runs);
    return runs;
}

}  // namespace corda::study
