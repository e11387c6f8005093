#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Tolerances of `exact` are powers of ten: a preview at another size, whose pixels are of nearly the same
/// size, shows the same bits. They are denoted by their digits.
constexpr std::array<double, 16> kTolerance{1.0,  1e-1, 1e-2,  1e-3,  1e-4,  1e-5,  1e-6,  1e-7,
                                            1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15};
constexpr std::size_t kMaxDigits = 3;
constexpr std::size_t kNextDigits = 2;  ///< more than the last trial's
/// More than the run's. By chance a run may err far less than its tolerance, and its check as much. False
/// estimates of 900 random chains: 2 at 2, none at 3 (worst 0.44 of the estimate) and 4 (0.35); of 400
/// strings that stretch, 9 at 2 and none at 4.
constexpr std::size_t kCheckDigits = 4;
/// For rigid nets, whose plans cost more: DOP853 takes fixed orders, so that a check at a thousandth errs
/// some 500 times less at all times.
constexpr std::size_t kNetCheckDigits = 3;

/// Rounding moves a chain about as much as a tolerance of 1e-12 (random chains of 2 to 24 links: 0.03 of the
/// error at 1e-10). A run and a check that both err by rounding may agree by chance, so the check of the
/// tightest run must be better.
struct TightestDigits {
    std::size_t run;
    std::size_t check;
};
constexpr TightestDigits kSmooth{10, 12};
/// For strings that stretch: at the kink where they come taut, errors are far larger than rounding (400 that
/// swing and snap: 42 horizons, 73 at 1e-10).
constexpr TightestDigits kWithKinks{13, 15};

/// A trial for closed ropes and nets: an order of `rattle` and how often its step is halved. In order of
/// cost; each gains several digits over its predecessor.
struct Rung {
    int order;
    int halvings;
};
constexpr std::array<Rung, 6> kGraphLadder{{{2, 0}, {4, 0}, {4, 1}, {6, 1}, {8, 1}, {8, 2}}};
/// Step and guard of a check as a share of its trial's. `rattle` halves steps where bars whip: with the same
/// guard, run and check may take the same steps and have the same errors. False estimates of 1000 rings: 20
/// at 1/2 of the step, 2 (by 1.5 at most) at 1/3.
constexpr double kCheckStep = 1.0 / 3.0;
/// Steps divide this, whatever the video's frame interval is, so that a preview shows the same motion.
constexpr double kNominalIntervalSeconds = 1.0 / 60.0;

bool has_kinks(const System& system) {
    return std::ranges::any_of(system.bodies, [](const Body& body) {
        return body.material.is_string && body.material.compliance_1_n > 0.0;
    });
}

/// Trials with implicit steps, which only long ropes have, are each ten times tighter than the last.
/// Positions err by about the tolerance, so a check at a quarter of it shows three quarters of the error,
/// in 1.6 times as many steps.
constexpr std::size_t kImplicitTrials = 3;
constexpr std::size_t kMaxImplicitDigits = 7;
constexpr double kLooser = 2.0;               ///< errors are 0.05 to 0.4 of the tolerance
constexpr double kLooserIfStretching = 1.25;  ///< up to 0.8 of it
constexpr double kImplicitCheck = 0.25;
constexpr double kFirstImplicitSteps = 300.0;  ///< short ones, which a start may need

/// The step that `rattle` of an order takes by default.
double default_step_s(const System& system, const WorldDef& world, int order) {
    const MethodDef rattle = RattleDef{order};
    if (!system.has_events())
        return Rattle(system, world, RattleDef{order}, kNominalIntervalSeconds).step_s();
    const auto solver = make_solver(system, world, {&rattle, 1}, kNominalIntervalSeconds);
    return fixed_step_s(solver->methods().front()).value_or(kNominalIntervalSeconds);
}

/// Of `rattle` in a step.
double stages_of(int order) {
    return static_cast<double>(composition(order).stages.size());
}

bool is_implicit(const MethodDef& method) {
    const auto* exact = std::get_if<ExactDef>(&method);
    return exact != nullptr && exact->implicit;
}

/// A trial that may be run.
struct Candidate {
    Trial trial;
    double effort;  ///< of a second of its run, in parts of that of other candidates
    int digits;     ///< powers of ten by which its errors are smaller than those of other candidates, roughly
};

Candidate candidate(const MethodDef& method, const MethodDef& check, double effort, int digits) {
    Candidate made{{}, effort, digits};
    made.trial.method = method;
    made.trial.check = check;
    return made;
}

/// Order of `rattle` that is tried first for nets that stretch: stability limits its steps and those of
/// `exact` alike, which err far less and cost some four times as much.
constexpr int kCheapOrder = 2;
/// Work of its run, in updates of a particle, up to which it is not tried: some 30 ms.
constexpr double kTooCheap = 6e5;

/// Trials of `exact`, each a hundred times tighter than the last, after cheaper ones: with implicit steps, or
/// of `rattle`.
std::vector<Candidate> exact_trials(const System& system, const WorldDef& world, double tolerance_m,
                                    double end_s) {
    std::vector<Candidate> trials;
    const TightestDigits& tightest = has_kinks(system) ? kWithKinks : kSmooth;
    // The links of a net are many times as long as its way from end to end.
    const Body& body = system.bodies.front();
    const MotionBounds start = whole_bounds_of_start(system);
    const Vec2 extent = start.max_m() - start.min_m();
    const bool is_net = !moves_as_chains(system, body);
    const bool is_rigid_net = is_net && body.material.compliance_1_n == 0.0;
    const double wanted = tolerance_m / (is_net ? extent.x + extent.y : largest_length_m(system));
    std::size_t digits = kMaxDigits;
    while (digits < tightest.run && kTolerance[digits] > wanted) ++digits;
    const double looser = body.material.compliance_1_n > 0.0 ? kLooserIfStretching : kLooser;
    std::size_t first = kMaxDigits;
    while (first < kMaxImplicitDigits && kTolerance[first] > looser * wanted) ++first;
    const double explicit_1_s = most_implicit_steps_1_s(system, body, world);
    for (std::size_t i = first; i < first + kImplicitTrials && i <= kMaxImplicitDigits; ++i) {
        const double steps_1_s =
            explicit_1_s > 0.0 ? implicit_steps_1_s(system, body, world, kTolerance[i]) : 0.0;
        if (!(steps_1_s < explicit_1_s)) break;
        trials.push_back(candidate(ExactDef{kTolerance[i], true},
                                   ExactDef{kImplicitCheck * kTolerance[i], true}, steps_1_s,
                                   static_cast<int>(i)));
    }
    if (is_net && !is_rigid_net && !refusal(system, world, RattleDef{kCheapOrder}, kNominalIntervalSeconds)) {
        const double step_s = default_step_s(system, world, kCheapOrder);
        const std::size_t check = std::min(digits + kNextDigits, tightest.check);
        if (end_s / step_s * static_cast<double>(system.particle_count()) > kTooCheap)
            trials.push_back(candidate(RattleDef{kCheapOrder, step_s}, ExactDef{kTolerance[check]}, 1.0,
                                       static_cast<int>(digits) - 1));
    }
    for (;; digits = std::min(digits + kNextDigits, tightest.run)) {
        const std::size_t check = digits + (is_rigid_net ? kNetCheckDigits : kCheckDigits);
        trials.push_back(candidate(ExactDef{kTolerance[digits]},
                                   ExactDef{kTolerance[std::min(check, tightest.check)]},
                                   explicit_1_s > 0.0 ? explicit_1_s : 1.0, static_cast<int>(digits)));
        if (digits == tightest.run) return trials;
    }
}

/// Trials of `rattle` for a graph, each checked by the next order (8 by 8) at kCheckStep of its step.
std::vector<Candidate> graph_trials(const System& system, const WorldDef& world, const PlanDef& def) {
    constexpr int kDigits = 4;  // from one to the next
    const std::int64_t none_done = 0;
    const CancelScope progress = report_frames(def, none_done);
    std::vector<Candidate> trials;
    int order = 0;
    double stable_s = 0.0;
    for (const Rung& rung : kGraphLadder) {
        if (rung.order != order) {  // a large net takes seconds to prepare
            order = rung.order;
            stable_s = default_step_s(system, world, order);
        }
        const double step_s = stable_s / static_cast<double>(1 << rung.halvings);
        trials.push_back(candidate(RattleDef{rung.order, step_s},
                                   RattleDef{std::min(rung.order + 2, RattleDef::kOrders.back()),
                                             kCheckStep * step_s, kCheckStep * RattleDef{}.guard},
                                   stages_of(rung.order) / step_s,
                                   kDigits * static_cast<int>(trials.size())));
    }
    return trials;
}

/// Rough work of a step in updates of a particle.
double updates_of_step(const System& system, const MethodDef& method) {
    constexpr double kOfExact = 8.0;
    const auto* rattle = std::get_if<RattleDef>(&method);
    return (rattle == nullptr ? kOfExact : stages_of(rattle->order)) *
           static_cast<double>(system.particle_count());
}

/// A trial that failed, and the bound on others that it gives.
struct Failure {
    std::size_t number;  ///< among the candidates
    double ran_s;        ///< its run, and its checks
    /// Upper bound of the time by which others reach farther, per digit; infinite if nothing shows it.
    double gain_s;
    double run_updates;   ///< work of its run
    double left_updates;  ///< work that planning may still take
};

/// Upper bound of the time by which trials reach farther than one that failed after `ran_s`, per digit: that
/// in which its difference grew tenfold. Infinite if the difference has not grown much.
double gain_by_growth_s(const System& system, const Trial& trial, double ran_s, double end_s) {
    constexpr double kDigitsOfHopeless = 1.2;
    // Than when it exceeded the tolerance: errors of chaotic motions grow in bursts.
    constexpr double kSlower = 4.0;
    // Bars that come into line, and strings that come taut, part a run from its check in no time.
    if (!std::holds_alternative<ExactDef>(trial.method) || has_kinks(system) || trial.diverged ||
        ran_s >= end_s)
        return HUGE_VAL;
    return kSlower / kDigitsOfHopeless * (ran_s - trial.reached_s);
}

/// The trial to run after one that failed: the cheapest that is worth its price and expected to hold; if none
/// is expected to hold, the one that is worth its price and expected to reach farthest. std::nullopt: none is
/// worth its price, and the run of the failed trial is drawn.
///
/// A price is the work of the run to the end and of the checks up to the time that is expected to be reached,
/// less that of ending the run that failed. All are in parts of a whole run of the method that failed.
std::optional<std::size_t> next_trial(const System& system, const std::vector<Candidate>& candidates,
                                      const Failure& failure, double end_s) {
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
    const double checks_per_step = static_cast<double>(failed.trial.check_steps) /
                                   static_cast<double>(std::max<std::uint64_t>(1, failed.trial.steps));
    const double run_updates = updates_of_step(system, failed.trial.method) *
                               static_cast<double>(failed.trial.steps) * end_s / failure.ran_s;
    const auto whole_price = [&](const Candidate& other) {
        const auto checks = static_cast<double>(check_count(system, other.trial.method, false));
        return other.effort / failed.effort * (1.0 + checks * checks_per_step * expected_s(other) / end_s);
    };
    const auto fits = [&](const Candidate& other) {
        return !(whole_price(other) * failure.run_updates * end_s > failure.left_updates * failure.ran_s);
    };
    std::size_t next = failure.number + 1;
    while (next + 1 < candidates.size() && expected_s(candidates[next]) < end_s) ++next;
    for (; next > failure.number && next < candidates.size(); --next) {
        const Candidate& other = candidates[next];
        if (!fits(other)) continue;
        const double hoped_s = expected_s(other);
        const double price = whole_price(other) - (1.0 - failure.ran_s / end_s);
        const double worth =
            hoped_s < end_s ? kWorthOfAHorizon * (hoped_s - failed.trial.reached_s) / end_s : kWorthOfTheEnd;
        const bool is_small = hoped_s > failed.trial.reached_s && price * run_updates <= kSmallUpdates;
        if (is_small || price <= worth) return next;
    }
    const auto* exact = std::get_if<ExactDef>(&failed.trial.method);
    if (exact == nullptr || exact->implicit || exact->tolerance <= kLooseTolerance) return std::nullopt;
    for (next = failure.number + 1; next < candidates.size(); ++next)
        if (std::get<ExactDef>(candidates[next].trial.method).tolerance <= kLooseTolerance)
            return fits(candidates[next]) ? std::optional(next) : std::nullopt;
    return std::nullopt;
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

/// Runs trials, cheapest first, until one holds to the end or no other is worth its price, and makes the last
/// one the plan. Ends at the first trial of `exact` that diverges for a graph of rigid bars: they have come
/// into line. Once trials have taken the work that planning may take, the run that failed last is drawn. If
/// its rest would take more than a run may, the run before it is drawn; without one, the body is refused.
void run_until_one_holds(const System& system, const WorldDef& world, const PlanDef& def,
                         std::vector<Candidate> candidates, BodyPlan& plan, Recording& recording) {
    const double end_s = def.timeline.time_s(def.timeline.size() - 1);
    double left_updates = def.share * def.most_updates();
    for (const Trial& trial : plan.trials) left_updates -= trial.updates;
    std::optional<std::size_t> last;
    for (std::optional<std::size_t> i = 0; i;) {
        Trial& trial = candidates[*i].trial;
        bool is_too_dear = false;
        TrialKind kind;
        kind.is_first = !last;
        kind.most_updates = left_updates;
        if (is_implicit(trial.method)) {
            kind.most_steps_1_s = candidates.back().effort;
            kind.first_steps = kFirstImplicitSteps + kind.most_steps_1_s * def.timeline.step_s();
        }
        std::optional<std::size_t> next;
        kind.is_last = [&](const Trial& failed, double ran_s, double run_updates) {
            trial = failed;
            Failure failure{*i, ran_s, gain_by_growth_s(system, failed, ran_s, end_s), run_updates,
                            left_updates - failed.updates};
            // Those with implicit steps say little of others.
            if (last && is_implicit(candidates[*last].trial.method) == is_implicit(trial.method)) {
                // Frames are a grid, and may be sparse.
                const double gained_s = std::max(0.0, failed.reached_s - candidates[*last].trial.reached_s) +
                                        def.timeline.step_s();
                const int digits = candidates[*i].digits - candidates[*last].digits;
                failure.gain_s = std::min(failure.gain_s, gained_s / digits);
            }
            next = next_trial(system, candidates, failure, end_s);
            is_too_dear = !next && run_updates * (end_s - ran_s) > def.most_updates_of_run() * ran_s;
            return !next && !is_too_dear;
        };
        plan.method = trial.method;
        trial = run_trial(system, world, def, kind, trial, recording);
        const bool ended = !trial.too_long;
        plan.passes += trial.passes;
        plan.trials.push_back(trial);
        left_updates -= trial.updates;
        if (is_too_dear || (!ended && !is_implicit(trial.method))) {
            if (!last) refuse_many_steps(trial, end_s);
            // The run before it takes less.
            std::swap(plan.trials.back(), *(plan.trials.end() - 2));
            plan.method = plan.trials.back().method;
            record(system, world, def, plan, recording);
            break;
        }
        while (!ended && (!next || is_implicit(candidates[*next].trial.method))) next = next.value_or(*i) + 1;
        if (has_come_into_line(system, trial)) break;
        if (ended) last = i;
        i = next;
    }
    const Trial& chosen = plan.trials.back();
    plan.error_estimate_m = chosen.error_estimate_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    plan.undecided = chosen.undecided;
    plan.unchecked = chosen.unchecked;
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
    const auto exact_refusal = refusal_of(ExactDef{kTolerance[kMaxDigits]});
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
            if (has_come_into_line(system, plan.trials.back()) && !refusal_of(RattleDef{})) {
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
