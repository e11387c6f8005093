#include "corda/sim/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "corda/core/error.hpp"
#include "corda/sim/rattle.hpp"

namespace corda::sim {
namespace {

constexpr double kLoosestTolerance = 1e-3;
constexpr double kTightestTolerance = 1e-13;  // below, rounding is all that is left
constexpr double kCheckPerTolerance = 1e-2;
constexpr double kTightestCheck = 1e-15;
constexpr double kScoutingTolerance = 1e-6;

constexpr std::array<int, 4> kOrders{2, 4, 6, 8};
/// What is tried for closed ropes and nets: an order of `rope` and how often its step is halved. In the order
/// of cost; each gains several digits on the one before it.
struct Rung {
    int order;
    int halvings;
};
constexpr std::array<Rung, 6> kGraphLadder{{{2, 0}, {4, 0}, {4, 1}, {6, 1}, {8, 1}, {8, 2}}};
/// An order of `rope` is tried where it costs less than this share of `exact`: a trial that fails costs a run
/// too.
constexpr double kWorthATrial = 0.7;

// Nanoseconds a particle and step at 20 to 1000 particles; `exact` with its tried steps.
constexpr double kExactCost = 140.0;
constexpr std::array<double, 4> kChainCosts{45.0, 180.0, 330.0, 600.0};  // of kOrders
constexpr double kStageCostInAGraph = 500.0;  // the factorisation of a cloth of 40 x 30
constexpr double kBarCost = 8.0;              // relaxation, a bar and sweep

std::size_t index_of(int order) {
    return static_cast<std::size_t>(order / 2 - 1);
}

double largest_length_m(const System& system) {
    double longest_m = 0.0;
    for (const Body& body : system.bodies) {
        double length_m = 0.0;
        for (std::size_t i = 0; i < body.link_count; ++i) length_m += system.bars[body.first_bar + i].rest_m;
        longest_m = std::max(longest_m, length_m);
    }
    return longest_m;
}

bool is_chains(const System& system) {
    return std::all_of(system.bodies.begin(), system.bodies.end(),
                       [](const Body& body) { return body.is_chain && body.material.compliance_1_n == 0.0; });
}

/// As many sweeps as keep a cloth of some thirty rows from sagging like rubber.
SolverDef fallback_solver(double frame_interval_s) {
    constexpr int kSweeps = 8;
    constexpr double kStepsAFrame = 4.0;
    return relaxation_solver(frame_interval_s / kStepsAFrame, 1, kSweeps);
}

/// Trials of `exact`, each a hundred times tighter than the last.
std::vector<Trial> exact_trials(const System& system, const PlanDef& def) {
    std::vector<Trial> trials;
    const double wanted = def.tolerance_m / largest_length_m(system);
    double tolerance = std::clamp(wanted, kTightestTolerance, kLoosestTolerance);
    for (bool tightest = false; !tightest; tolerance *= kCheckPerTolerance) {
        tightest = tolerance <= kTightestTolerance;
        Trial& trial = trials.emplace_back();
        trial.solver = exact_solver(std::max(tolerance, kTightestTolerance));
        trial.check = exact_solver(std::max(kCheckPerTolerance * trial.solver.tolerance, kTightestCheck));
    }
    return trials;
}

/// Orders of `rope` at the step that it chooses itself where they are cheaper than `limit_ns` from the start
/// to the end, cheapest first; all checked by `check`.
std::vector<Trial> cheaper_rope_trials(const System& system, const WorldDef& world, const PlanDef& def,
                                       const SolverDef& check, double limit_ns) {
    std::vector<Trial> trials;
    for (const int order : kOrders) {
        Trial trial;
        trial.solver = rope_solver(order);
        trial.check = check;
        const Rattle rope(system, world, trial.solver, def.frames.interval_s());
        trial.solver.step_s = rope.step_s();
        const double steps = def.frames.time_s(def.last_frame) / rope.step_s();
        if (steps * step_cost_ns(system, trial.solver) < kWorthATrial * limit_ns) trials.push_back(trial);
    }
    return trials;
}

/// Trials of `rope` for a graph; each checked by the next order, or 8 again, at half its step.
std::vector<Trial> graph_trials(const System& system, const WorldDef& world, double frame_interval_s) {
    std::vector<Trial> trials;
    for (const Rung& rung : kGraphLadder) {
        const double stable_s = Rattle(system, world, rope_solver(rung.order), frame_interval_s).step_s();
        const double step_s = stable_s / static_cast<double>(1 << rung.halvings);
        Trial& trial = trials.emplace_back();
        trial.solver = rope_solver(rung.order, step_s);
        trial.check = rope_solver(std::min(rung.order + 2, kOrders.back()), 0.5 * step_s);
    }
    return trials;
}

/// Makes the last of the trials the plan.
void adopt_last(const System& system, std::vector<Trial> trials, Plan& plan) {
    const Trial& chosen = trials.back();
    plan.solver = chosen.solver;
    plan.error_bound_m = bound_per_difference(system) * chosen.largest_difference_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    plan.diverges = chosen.diverged;
    plan.trials = std::move(trials);
}

/// Whether a trial of `exact` on bodies that stretch or bend proves what it shows. Where their vibrations
/// limit the steps, a run and its check take about the same ones and damp what is too quick for them alike:
/// then they are nearer to each other than to the truth.
bool is_proof(const System& system, const Trial& trial) {
    constexpr double kLeastMoreSteps =
        1.25;  // a hundredth of the tolerance is 1.8 times the steps at order 8
    const bool vibrates = !system.bends.empty() ||
                          std::any_of(system.bodies.begin(), system.bodies.end(),
                                      [](const Body& body) { return body.material.compliance_1_n > 0.0; });
    if (!trial.to_the_end || !vibrates || trial.solver.method != Method::kExact) return trial.to_the_end;
    return static_cast<double>(trial.check_steps) >= kLeastMoreSteps * static_cast<double>(trial.steps);
}

/// Moves to the end the trial that proves itself or, where none does, the one that got farthest; of equals
/// the first, which is the cheapest, and of those that got to the end without a proof the last, the tightest.
void put_best_last(const System& system, std::vector<Trial>& trials) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < trials.size(); ++k) {
        const bool is_proved = is_proof(system, trials[k]);
        const bool best_is_proved = is_proof(system, trials[best]);
        const bool is_better = is_proved != best_is_proved ? is_proved
                               : trials[k].to_the_end && trials[best].to_the_end
                                   ? !is_proved
                                   : trials[k].reached_s > trials[best].reached_s;
        if (is_better) best = k;
    }
    const auto chosen = trials.begin() + static_cast<std::ptrdiff_t>(best);
    std::rotate(chosen, chosen + 1, trials.end());
}

/// Whether two trials in a row gave up at the same time: then a finer one would too.
bool give_up_together(const Trial& a, const Trial& b) {
    return a.diverged && b.diverged && a.reached_s == b.reached_s;
}

/// Runs the trials one after the other until one proves itself, and puts the best one last.
std::vector<Trial> run_until_one_holds(const System& system, const WorldDef& world, const PlanDef& def,
                                       std::vector<Trial> trials) {
    for (std::size_t k = 0; k < trials.size(); ++k) {
        run_trial(system, world, def, trials[k]);
        const bool is_last =
            is_proof(system, trials[k]) || (k > 0 && give_up_together(trials[k - 1], trials[k]));
        if (!is_last) continue;
        trials.resize(k + 1);
        break;
    }
    put_best_last(system, trials);
    return trials;
}

Plan plan_exact(const System& system, const WorldDef& world, const PlanDef& def) {
    Plan plan;
    adopt_last(system, run_until_one_holds(system, world, def, exact_trials(system, def)), plan);
    plan.reason =
        "exact moves every body of this scene, and no order of rope would cost less at a stable step";
    if (plan.horizon_s) return plan;
    const Trial exact = plan.trials.back();
    if (!refusal(system, world, rope_solver(2), def.frames.interval_s()).empty()) return plan;
    const double cost_ns = static_cast<double>(exact.steps) * step_cost_ns(system, exact.solver);
    std::vector<Trial> ropes = cheaper_rope_trials(system, world, def, exact.check, cost_ns);
    if (ropes.empty()) return plan;
    ropes = run_until_one_holds(system, world, def, std::move(ropes));
    if (!ropes.back().to_the_end) {
        plan.trials.insert(plan.trials.begin(), ropes.begin(), ropes.end());
        plan.reason =
            "exact moves every body of this scene; orders of rope that would cost less miss the tolerance";
        return plan;
    }
    ropes.insert(ropes.begin(), plan.trials.begin(), plan.trials.end());
    adopt_last(system, std::move(ropes), plan);
    plan.reason = "rope at a stable step is good enough here and costs less than exact";
    return plan;
}

}  // namespace

double step_cost_ns(const System& system, const SolverDef& solver) {
    const auto particles = static_cast<double>(system.particle_count());
    switch (solver.method) {
        case Method::kAuto:
            return 0.0;
        case Method::kRelaxation:
            return kBarCost * static_cast<double>(system.bars.size()) * solver.sweeps;
        case Method::kRope:
            if (is_chains(system)) return kChainCosts[index_of(solver.order)] * particles;
            return kStageCostInAGraph * particles *
                   static_cast<double>(composition(solver.order).stages.size());
        case Method::kExact:
            return kExactCost * particles;
    }
    return 0.0;
}

SolverDef scouting_solver(const System& system, const WorldDef& world, double frame_interval_s) {
    const SolverDef exact = exact_solver(kScoutingTolerance);
    const std::string exact_refusal = refusal(system, world, exact, frame_interval_s);
    if (exact_refusal.empty()) return exact;
    if (is_chains(system)) throw Error(ExitCode::kInvalidScene, exact_refusal);
    const std::string rope_refusal = refusal(system, world, rope_solver(4), frame_interval_s);
    if (rope_refusal.empty()) return rope_solver(4);
    const SolverDef relaxation = fallback_solver(frame_interval_s);
    if (refusal(system, world, relaxation, frame_interval_s).empty()) return relaxation;
    throw Error(ExitCode::kInvalidScene, rope_refusal);
}

Plan plan_solver(const System& system, const WorldDef& world, const PlanDef& def) {
    const double interval_s = def.frames.interval_s();
    const SolverDef scout = scouting_solver(system, world, interval_s);
    if (scout.method == Method::kExact) return plan_exact(system, world, def);
    Plan plan;
    if (scout.method == Method::kRope) {
        adopt_last(system, run_until_one_holds(system, world, def, graph_trials(system, world, interval_s)),
                   plan);
        plan.reason = "rope keeps the bars of closed ropes and nets at their lengths";
        const bool holds = !plan.trials.back().diverged;
        const SolverDef relaxation = fallback_solver(interval_s);
        if (holds || !refusal(system, world, relaxation, interval_s).empty()) return plan;
        plan.solver = relaxation;
        plan.error_bound_m = std::nullopt;
        plan.horizon_s = std::nullopt;
        plan.diverges = false;
        plan.reason =
            "bars of a closed rope or a net come to lie in line on their way, where their tensions are not "
            "determined and rope ends; relaxation runs it, without a bound of the error";
        return plan;
    }
    plan.solver = scout;
    plan.reason =
        "the bars depend on each other (diagonals, or a row straight between pins), so that no method can "
        "tell "
        "the true motion; relaxation runs it, without a bound of the error";
    return plan;
}

}  // namespace corda::sim
