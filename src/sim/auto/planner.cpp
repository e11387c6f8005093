#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "corda/sim/rattle/rattle.hpp"

namespace corda::sim {
namespace {

constexpr double kLoosestTolerance = 1e-3;
constexpr double kTightestTolerance = 1e-13;  // below, errors are rounding
constexpr double kCheckPerTolerance = 1e-2;

/// A trial for closed ropes and nets: an order of `rattle` and how often its step is halved. In order of
/// cost; each gains several digits on the one before.
struct Rung {
    int order;
    int halvings;
};
constexpr std::array<Rung, 6> kGraphLadder{{{2, 0}, {4, 0}, {4, 1}, {6, 1}, {8, 1}, {8, 2}}};

/// Trials of `exact`, each a hundred times tighter than the last. The first tolerance is a power of ten, so
/// that pictures of nearly the same scale show the same bits.
std::vector<Trial> exact_trials(const System& system, double tolerance_m) {
    std::vector<Trial> trials;
    const double wanted =
        std::clamp(tolerance_m / largest_length_m(system), kTightestTolerance, kLoosestTolerance);
    double tolerance = kLoosestTolerance;
    while (tolerance > 1.000001 * wanted) tolerance *= 0.1;
    for (bool is_tightest = false; !is_tightest; tolerance *= kCheckPerTolerance) {
        is_tightest = tolerance <= 1.000001 * kTightestTolerance;
        const double chosen = std::max(tolerance, kTightestTolerance);
        Trial& trial = trials.emplace_back();
        trial.method = ExactDef{chosen};
        trial.check = ExactDef{std::max(kCheckPerTolerance * chosen, ExactDef::kTightestTolerance)};
    }
    return trials;
}

/// Trials of `rattle` for a graph, each checked by the next order (8 by 8) at half its step.
std::vector<Trial> graph_trials(const System& system, const WorldDef& world, double frame_interval_s) {
    std::vector<Trial> trials;
    for (const Rung& rung : kGraphLadder) {
        const double stable_s = Rattle(system, world, RattleDef{rung.order}, frame_interval_s).step_s();
        const double step_s = stable_s / static_cast<double>(1 << rung.halvings);
        Trial& trial = trials.emplace_back();
        trial.method = RattleDef{rung.order, step_s};
        trial.check = RattleDef{std::min(rung.order + 2, RattleDef::kOrders.back()), 0.5 * step_s};
    }
    return trials;
}

/// Whether a trial proves its error. If vibrations of bodies that stretch or bend limit the steps of `exact`,
/// a run and its check take about the same steps and damp quick vibrations alike: they are then nearer to
/// each other than to the truth.
bool is_proof(const System& system, const Trial& trial) {
    constexpr double kLeastMoreSteps =
        1.25;  // a hundredth of the tolerance is 1.8 times the steps at order 8
    const bool vibrates = !system.bends.empty() ||
                          std::any_of(system.bodies.begin(), system.bodies.end(),
                                      [](const Body& body) { return body.material.compliance_1_n > 0.0; });
    if (!trial.to_the_end || !vibrates || !std::holds_alternative<ExactDef>(trial.method))
        return trial.to_the_end;
    return static_cast<double>(trial.check_steps) >= kLeastMoreSteps * static_cast<double>(trial.steps);
}

/// Whether two trials in a row diverged at the same time: a finer one would too.
bool give_up_together(const Trial& a, const Trial& b) {
    return a.diverged && b.diverged && a.reached_s == b.reached_s;
}

/// Runs the trials one after the other until one proves its error, and makes the last one the plan.
void run_until_one_holds(const System& system, const WorldDef& world, const PlanDef& def,
                         std::vector<Trial> trials, Plan& plan, Recording& recording) {
    for (Trial& trial : trials) {
        const bool is_last = &trial == &trials.back();
        run_trial(system, world, def, is_last, trial, recording, plan.simulation_passes);
        plan.trials.push_back(trial);
        const std::size_t count = plan.trials.size();
        if (is_proof(system, trial)) break;
        if (count > 1 && give_up_together(plan.trials[count - 2], trial)) break;
    }
    const Trial& chosen = plan.trials.back();
    plan.method = chosen.method;
    plan.error_bound_m = bound_per_difference(system) * chosen.largest_difference_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    plan.diverges = chosen.diverged;
}

/// Makes `relaxation` the plan, without a bound on its error, with enough sweeps to keep a cloth of some
/// thirty rows from sagging like rubber.
void fall_back(const System& system, const WorldDef& world, const PlanDef& def, PlanReason reason, Plan& plan,
               Recording& recording) {
    constexpr int kSweeps = 8;
    constexpr double kStepsPerFrame = 4.0;
    const double interval_s = def.timeline.fps().interval_s();
    plan.method = RelaxationDef{interval_s / kStepsPerFrame, kSweeps};
    plan.error_bound_m = std::nullopt;
    plan.horizon_s = std::nullopt;
    plan.diverges = false;
    plan.reason = reason;
    Simulation run(system, world, plan.method, interval_s);
    recording.clear();
    ++plan.simulation_passes;
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    for (std::int64_t i = 0; i < total; ++i) {
        report_progress(def.on_progress, i, total);
        const double time_s = def.timeline.time_s(static_cast<std::size_t>(i));
        if (recording.advance(run, time_s, def.clock_s) == Status::kDiverged) return;
    }
}

bool is_chains(const System& system) {
    return std::all_of(system.bodies.begin(), system.bodies.end(),
                       [](const Body& body) { return body.is_chain && body.material.compliance_1_n == 0.0; });
}

}  // namespace

double step_cost_ns(const System& system, const MethodDef& method) {
    // Per particle and step at 20 to 1000 particles; of `rattle` at orders 2, 4, 6, 8.
    constexpr double kExactCost = 140.0;
    constexpr std::array<double, RattleDef::kOrders.size()> kChainCosts{45.0, 180.0, 330.0, 600.0};
    constexpr double kStageCostInAGraph = 500.0;  // the factorisation of a cloth of 40 x 30
    constexpr double kBarCost = 8.0;              // relaxation, per bar and sweep
    const auto particles = static_cast<double>(system.particle_count());
    if (const auto* relaxation = std::get_if<RelaxationDef>(&method))
        return kBarCost * static_cast<double>(system.bars.size()) * relaxation->sweeps;
    if (const auto* rattle = std::get_if<RattleDef>(&method)) {
        if (is_chains(system))
            return kChainCosts[static_cast<std::size_t>(rattle->order / 2 - 1)] * particles;
        return kStageCostInAGraph * particles * static_cast<double>(composition(rattle->order).stages.size());
    }
    return kExactCost * particles;
}

Plan plan_method(const System& system, const WorldDef& world, const PlanDef& def, Recording& recording) {
    const double interval_s = def.timeline.fps().interval_s();
    Plan plan;
    const auto exact_refusal = refusal(system, world, ExactDef{kLoosestTolerance}, interval_s);
    if (!exact_refusal) {
        plan.reason = PlanReason::kExact;
        MotionBounds start;
        start.include({0.0, system.x_m, system.y_m});
        run_until_one_holds(system, world, def, exact_trials(system, def.tolerance_m(start)), plan,
                            recording);
        return plan;
    }
    if (is_chains(system) || exact_refusal->reason() == Refusal::Reason::kBarWithoutLength)
        throw Refusal(*exact_refusal);
    const bool can_fall_back = !refusal(system, world, RelaxationDef{}, interval_s);
    if (const auto rattle_refusal = refusal(system, world, RattleDef{}, interval_s)) {
        if (!can_fall_back) throw Refusal(*rattle_refusal);
        fall_back(system, world, def, PlanReason::kDependent, plan, recording);
        return plan;
    }
    plan.reason = PlanReason::kGraph;
    run_until_one_holds(system, world, def, graph_trials(system, world, interval_s), plan, recording);
    if (plan.diverges && can_fall_back)
        fall_back(system, world, def, PlanReason::kCollapsing, plan, recording);
    return plan;
}

}  // namespace corda::sim
