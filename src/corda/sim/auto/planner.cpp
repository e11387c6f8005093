#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/sim/auto/tolerances.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// A trial that failed, and the bound on others that it gives.
struct Failure {
    std::size_t number;  ///< among the candidates
    double ran_s;        ///< its run, and its checks
    /// Upper bound of the time by which others reach farther, per digit; infinite if nothing shows it.
    double gain_s;
    double run_updates;   ///< work of its run
    double left_updates;  ///< work that planning may still take
};

/// Upper bound of the time by which trials reach farther than one that failed after `ran_s`, per digit: the
/// smaller one of that in which its difference grew tenfold and of that by which it reached beyond the trial
/// before, plus a frame. Infinite if neither is known.
double most_gain_s(const System& system, const Candidate& failed, const Candidate* before, double ran_s,
                   const Timeline& timeline, double end_s) {
    constexpr double kDigitsOfHopeless = 1.2;
    // Than when it exceeded the tolerance: errors of chaotic motions grow in bursts.
    constexpr double kSlower = 4.0;
    const Trial& trial = failed.trial;
    // Links that buckle in a second check may not buckle in explicit steps.
    if (may_buckle_unseen(system, trial.method)) return HUGE_VAL;
    // Bars that come into line, and strings that come taut, part a run from its check in no time.
    const bool shows_growth = std::holds_alternative<ExactDef>(trial.method) && !has_kinks(system) &&
                              !trial.diverged && ran_s < end_s;
    const double by_growth_s =
        shows_growth ? kSlower / kDigitsOfHopeless * (ran_s - trial.reached_s) : HUGE_VAL;
    // Implicit steps say little of explicit ones.
    if (before == nullptr || is_implicit(before->trial.method) != is_implicit(trial.method))
        return by_growth_s;
    // Frames are a grid, and may be sparse.
    const double gained_s = std::max(0.0, trial.reached_s - before->trial.reached_s) + timeline.step_s();
    return std::min(by_growth_s, gained_s / (failed.digits - before->digits));
}

/// The candidate that follows, if any does.
struct Next {
    std::optional<std::size_t> number;
    bool exceeds_budget = false;  ///< a trial would be worth its price, but not fit into the budget
};

/// Chooses the trial to run after one that failed: among trials worth their price, the cheapest that is
/// expected to hold, or else the trial expected to reach farthest. If no trial is worth its price, the run of
/// the failed trial is drawn.
///
/// A price is the work of the run to the end and of the checks up to the time that is expected to be reached,
/// less that of ending the run that failed. All are in parts of a whole run of the method that failed.
Next next_trial(const System& system, const std::vector<Candidate>& candidates, const Failure& failure,
                double end_s) {
    const auto expected_s = [&](const Candidate& next) {
        const int digits = next.digits - candidates[failure.number].digits;
        const double reached_s = candidates[failure.number].trial.reached_s;
        return digits > 0 ? std::min(reached_s + digits * failure.gain_s, end_s) : reached_s;
    };
    constexpr double kWorthOfTheEnd = 200.0;   // of holding to the end
    constexpr double kWorthOfAHorizon = 30.0;  // of a horizon that is later by the whole motion
    constexpr double kSmallUpdates = 2e6;      // about 0.1 s: worth any gain
    constexpr double kLooseTolerance = 1e-6;   // a looser run drifts visibly
    const Candidate& failed = candidates[failure.number];
    // How many times as dear as expected checks are. Runs of other outcomes of snaps count as checks.
    const double dearer = (failed.trial.updates / std::max(1.0, failure.run_updates) - 1.0) * failed.effort /
                          failed.checks_effort * static_cast<double>(checks_of(system, failed.trial).size()) /
                          std::max(1.0, failed.trial.passes - 1.0);
    const double whole_updates = failure.run_updates * end_s / failure.ran_s;
    const auto whole_price = [&](const Candidate& other) {
        return (other.effort + dearer * other.checks_effort * expected_s(other) / end_s) / failed.effort;
    };
    const auto fits = [&](const Candidate& other) {
        return !(whole_price(other) * whole_updates > failure.left_updates);
    };
    bool exceeds_budget = false;
    std::size_t next = failure.number + 1;
    while (next + 1 < candidates.size() && expected_s(candidates[next]) < end_s) ++next;
    for (; next > failure.number && next < candidates.size(); --next) {
        const Candidate& other = candidates[next];
        const double hoped_s = expected_s(other);
        const double price = whole_price(other) - (1.0 - failure.ran_s / end_s);
        const double worth =
            hoped_s < end_s ? kWorthOfAHorizon * (hoped_s - failed.trial.reached_s) / end_s : kWorthOfTheEnd;
        const bool is_small = hoped_s > failed.trial.reached_s && price * whole_updates <= kSmallUpdates;
        if (!is_small && !(price <= worth)) continue;
        if (fits(other)) return {next, false};
        exceeds_budget = true;
    }
    const auto* exact = std::get_if<ExactDef>(&failed.trial.method);
    if (exact == nullptr || exact->implicit || exact->tolerance <= kLooseTolerance)
        return {{}, exceeds_budget};
    for (next = failure.number + 1; next < candidates.size(); ++next) {
        if (std::get<ExactDef>(candidates[next].trial.method).tolerance > kLooseTolerance) continue;
        if (fits(candidates[next])) return {next, false};
        break;
    }
    return {{}, exceeds_budget};
}

/// Records the run of a plan's method.
void record(const System& system, const WorldDef& world, const PlanDef& def, BodyPlan& plan,
            Recording& recording) {
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    std::int64_t i = 0;
    const CancelScope progress = report_frames(def, i);
    Simulation run(system, world, plan.method, def.timeline.step_s());
    plan.method = run.methods().front();
    recording.clear();
    ++plan.passes;
    for (; i < total; ++i) {
        check_cancelled();
        if (recording.advance(run, def.timeline, def.clock_s) == Status::kDiverged) return;
    }
}

/// True if a trial of `exact` ended where the rigid bars of a graph come into line.
bool has_come_into_line(const System& system, const Trial& trial) {
    const Body& body = system.bodies.front();
    const bool is_rigid_graph =
        !moves_as_chains(system, body) && body.material.compliance_1_n == 0.0 && !body.material.is_string;
    return is_rigid_graph && trial.diverged && std::holds_alternative<ExactDef>(trial.method);
}

[[noreturn]] void refuse_many_steps(const Trial& trial, double end_s) {
    throw Refusal(Refusal::Reason::kManySteps,
                  fmt::format("its motion takes so many steps ({} of {} were not enough for {:.2g} s) that "
                              "method auto gives up",
                              trial.steps, method_text(trial.method), end_s));
}

/// Draws the run of an earlier trial again, and makes it the last.
void go_back_to(std::size_t number, const System& system, const WorldDef& world, const PlanDef& def,
                BodyPlan& plan, Recording& recording) {
    std::swap(plan.trials[number], plan.trials.back());
    plan.method = plan.trials.back().method;
    record(system, world, def, plan, recording);
}

/// Copies the figures of the run that is drawn into the plan.
void take_figures(const System& system, const Trial& chosen, BodyPlan& plan) {
    plan.error_estimate_m = chosen.error_estimate_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    plan.undecided = chosen.undecided;
    // Explicit steps might reach farther.
    plan.unchecked = chosen.unchecked || (!chosen.to_the_end && may_buckle_unseen(system, chosen.method));
}

/// Runs trials, cheapest first, until one holds to the end or no other is worth its price, and makes the last
/// one the plan, or one that reached farther by a tenth. Ends at the first trial of `exact` that diverges for
/// a graph of rigid bars: they have come into line. Once trials have taken the work that planning may take,
/// the run that failed last is drawn, or that one. If its rest would take more than a run may, that of the
/// last trial that ended is drawn; without one, the body is refused. Of implicit steps that are too many, the
/// next explicit ones follow.
void run_until_one_holds(const System& system, const WorldDef& world, const PlanDef& def,
                         std::vector<Candidate> candidates, BodyPlan& plan, Recording& recording) {
    constexpr double kShortSteps = 300.0;  // that a start may need
    constexpr double kFarther = 1.1;       // by less, the tighter run is better: it errs less until then
    const double end_s = def.timeline.time_s(def.timeline.size() - 1);
    double left_updates = def.share * def.most_updates();
    for (const Trial& trial : plan.trials) left_updates -= trial.updates;
    const auto first = static_cast<std::ptrdiff_t>(plan.trials.size());
    Next next;
    std::optional<std::size_t> last;
    std::size_t last_ended = 0;  // of plan.trials
    for (std::optional<std::size_t> i = 0; i;) {
        Trial& trial = candidates[*i].trial;
        bool is_too_dear = false;
        TrialKind kind;
        kind.most_updates = left_updates;
        kind.most_steps_1_s = candidates[*i].most_steps_1_s;
        kind.first_steps = kShortSteps + kind.most_steps_1_s * def.timeline.step_s();
        next = {};
        kind.is_last = [&](const Trial& failed, double ran_s, double run_updates) {
            trial = failed;
            const Candidate* const before = last ? &candidates[*last] : nullptr;
            const double gain_s = most_gain_s(system, candidates[*i], before, ran_s, def.timeline, end_s);
            next = next_trial(system, candidates,
                              {*i, ran_s, gain_s, run_updates, left_updates - failed.updates}, end_s);
            is_too_dear = !next.number && run_updates * (end_s - ran_s) > def.most_updates_of_run() * ran_s;
            return !next.number && !is_too_dear;
        };
        plan.method = trial.method;
        trial = run_trial(system, world, def, kind, trial, recording);
        const bool ended = !trial.too_long;
        plan.passes += trial.passes;
        plan.trials.push_back(trial);
        left_updates -= trial.updates;
        if (is_too_dear || (!ended && !is_implicit(trial.method))) {
            if (!last) refuse_many_steps(trial, end_s);
            // The run of the last trial that ended takes less.
            go_back_to(last_ended, system, world, def, plan, recording);
            break;
        }
        while (!ended && (!next.number || is_implicit(candidates[*next.number].trial.method)))
            next.number = next.number.value_or(*i) + 1;
        if (has_come_into_line(system, trial)) break;
        if (ended) last = i, last_ended = plan.trials.size() - 1;
        i = next.number;
    }
    const auto farthest =
        std::ranges::max_element(plan.trials.begin() + first, plan.trials.end(), {}, &Trial::reached_s);
    if (farthest->reached_s > kFarther * plan.trials.back().reached_s)
        go_back_to(static_cast<std::size_t>(farthest - plan.trials.begin()), system, world, def, plan,
                   recording);
    take_figures(system, plan.trials.back(), plan);
    plan.unchecked = plan.unchecked || (plan.horizon_s && next.exceeds_budget);
    plan.diverges = recording.size() < def.timeline.size();
}

/// Makes `relaxation` the plan, without an estimate of its error, with enough sweeps to keep a cloth of some
/// thirty rows from sagging like rubber.
void fall_back(const System& system, const WorldDef& world, const PlanDef& def, PlanReason reason,
               BodyPlan& plan, Recording& recording) {
    constexpr int kSweeps = 8;
    constexpr double kSteps = 4.0;  // in the nominal interval
    plan.method = RelaxationDef{kNominalIntervalSeconds / kSteps, kSweeps};
    plan.error_estimate_m = std::nullopt;
    plan.horizon_s = std::nullopt;
    plan.diverges = false;
    plan.reason = reason;
    record(system, world, def, plan, recording);
}

bool is_rigid_chain(const Body& body) {
    return body.is_chain && body.material.compliance_1_n == 0.0;
}

BodyPlan record_named(const System& system, const WorldDef& world, const PlanDef& def,
                      const MethodDef& method, Recording& recording) {
    BodyPlan plan;
    plan.method = method;
    record(system, world, def, plan, recording);
    return plan;
}

/// The reason why a recorded body never moves: it is a rigid plate, by Maxwell's count of its bars, or its
/// pins hold a straight row.
StandsStill why_still(const System& system, const Recording& recording) {
    constexpr double kStill = 1e-9;  // of the length
    const Body& body = system.bodies.front();
    if (!body.is_net || body.material.compliance_1_n > 0.0 || pin_count(system, body) < 2)
        return StandsStill::kNo;
    const MotionBounds start = whole_bounds_of_start(system);
    const double still_m = kStill * links_length_m(system, body);
    const auto near = [still_m](Vec2 a, Vec2 b) {
        return std::abs(a.x - b.x) <= still_m && std::abs(a.y - b.y) <= still_m;
    };
    if (!near(start.min_m(), recording.bounds().min_m()) || !near(start.max_m(), recording.bounds().max_m()))
        return StandsStill::kNo;
    if (body.bar_count + 3 >= 2 * body.particle_count) return StandsStill::kPlate;
    const bool holds_row = inverse_masses_with_taut_rows_held(system) != system.inverse_mass_1_kg;
    return holds_row ? StandsStill::kRow : StandsStill::kNo;
}

/// Combines the plans of the bodies, and counts how often all particles together were integrated.
void sum_up(const System& system, Plan& plan) {
    plan.error_estimate_m = 0.0;
    std::size_t integrated = 0;
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const BodyPlan& body = plan.bodies[i];
        integrated += static_cast<std::size_t>(body.passes) * system.bodies[i].particle_count;
        if (body.horizon_s) plan.horizon_s = std::min(*body.horizon_s, plan.horizon_s.value_or(HUGE_VAL));
        if (!body.error_estimate_m)
            plan.error_estimate_m = std::nullopt;
        else if (plan.error_estimate_m)
            plan.error_estimate_m = std::max(*plan.error_estimate_m, *body.error_estimate_m);
    }
    const std::size_t particles = system.particle_count();
    plan.simulation_passes = static_cast<int>((integrated + particles - 1) / particles);
}

}  // namespace

BodyPlan plan_body(const System& system, const WorldDef& world, const PlanDef& def, Recording& recording) {
    const double interval_s = def.timeline.step_s();
    const auto refusal_of = [&](const MethodDef& method) {
        const std::int64_t none_done = 0;
        const CancelScope progress = report_frames(def, none_done);
        return refusal(system, world, method, interval_s);
    };
    BodyPlan plan;
    const auto exact_refusal = refusal_of(loosest_exact());
    if (exact_refusal && (is_rigid_chain(system.bodies.front()) ||
                          exact_refusal->reason() == Refusal::Reason::kBarWithoutLength))
        throw Refusal(*exact_refusal);
    plan.reason = exact_refusal ? PlanReason::kGraph : PlanReason::kExact;
    try {
        if (exact_refusal) {
            if (const auto rattle_refusal = refusal_of(RattleDef{})) throw Refusal(*rattle_refusal);
            // A check, whose start is turned, may take bars to depend on each other that the run does not.
            run_until_one_holds(system, world, def, graph_trials(system, world, def), plan, recording);
        } else {
            const double tolerance_m = def.tolerance_m(whole_bounds_of_start(system));
            run_until_one_holds(system, world, def, exact_trials(system, world, tolerance_m, def.last_s()),
                                plan, recording);
            // `rattle` passes lines of bars.
            const bool is_in_line = std::ranges::any_of(
                plan.trials, [&](const Trial& trial) { return has_come_into_line(system, trial); });
            if (is_in_line && !refusal_of(RattleDef{})) {
                plan.horizon_s = std::nullopt;
                plan.reason = PlanReason::kGraph;
                run_until_one_holds(system, world, def, graph_trials(system, world, def), plan, recording);
            }
        }
        const bool is_exact = std::holds_alternative<ExactDef>(plan.method);
        if (plan.reason == PlanReason::kExact && !is_exact) plan.reason = PlanReason::kCheapest;
    } catch (const Refusal& refused) {
        const bool has_many_steps = refused.reason() == Refusal::Reason::kManySteps;
        if ((plan.reason != PlanReason::kGraph && !has_many_steps) || refusal_of(RelaxationDef{})) throw;
        fall_back(system, world, def, has_many_steps ? PlanReason::kManySteps : PlanReason::kDependent, plan,
                  recording);
    }
    return plan;
}

Plan plan_methods(const System& system, const NamedMethods& named, const WorldDef& world, const PlanDef& def,
                  Recording& recording) {
    Plan plan;
    MotionBounds known = whole_bounds_of_start(system);
    const auto count = static_cast<std::int64_t>(system.bodies.size());
    double updates = 0.0;
    std::optional<Recording> part;  // of the last body: the next one is often as large
    recording.clear();
    for_each_body(system, [&](const System& body, std::size_t i) {
        PlanDef of_body = def;
        of_body.tolerance_m = [&](const MotionBounds& bounds) {
            MotionBounds all = known;
            all.include(bounds);
            return def.tolerance_m(all);
        };
        of_body.on_progress = [&](std::int64_t done, std::int64_t total) {
            report_progress(def.on_progress, static_cast<std::int64_t>(i) * total + done, count * total);
            return true;
        };
        of_body.share =
            std::max(1.0 - updates / def.most_updates(), static_cast<double>(body.particle_count()) /
                                                             static_cast<double>(system.particle_count()));
        const auto plan_into = [&](Recording& own) {
            BodyPlan& made =
                plan.bodies.emplace_back(named[i] ? record_named(body, world, of_body, *named[i], own)
                                                  : plan_body(body, world, of_body, own));
            for (const Trial& trial : made.trials) updates += trial.updates;
            if (made.reason != PlanReason::kNamed) made.stands_still = why_still(body, own);
            known.include(own.bounds());
        };
        if (count == 1) return plan_into(recording);
        if (!part || !part->fits(body.particle_count(), body.bars.size()))
            part.emplace(recording.for_part(body.particle_count(), body.bars.size()));
        plan_into(*part);
        recording.add_body(*part, system.bodies[i].first_particle, system.bodies[i].first_bar);
    });
    sum_up(system, plan);
    return plan;
}

}  // namespace corda::sim
