#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "corda/core/cancel.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/rattle/rattle.hpp"
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
constexpr double kLooser = 2.0;  ///< errors are 0.05 to 0.4 of the tolerance
constexpr double kImplicitCheck = 0.25;

bool is_implicit(const MethodDef& method) {
    const auto* exact = std::get_if<ExactDef>(&method);
    return exact != nullptr && exact->implicit;
}

/// Trials of `exact`, each a hundred times tighter than the last, after those with implicit steps.
std::vector<Trial> exact_trials(const System& system, const WorldDef& world, double tolerance_m) {
    std::vector<Trial> trials;
    const TightestDigits& tightest = has_kinks(system) ? kWithKinks : kSmooth;
    // The links of a net are many times as long as its way from end to end.
    const Body& body = system.bodies.front();
    MotionBounds start;
    start.include({0.0, system.x_m, system.y_m});
    const Vec2 extent = start.max_m() - start.min_m();
    const bool is_net = !moves_as_chains(system, body);
    const bool is_rigid_net = is_net && body.material.compliance_1_n == 0.0;
    const double wanted = tolerance_m / (is_net ? extent.x + extent.y : largest_length_m(system));
    std::size_t digits = kMaxDigits;
    while (digits < tightest.run && kTolerance[digits] > wanted) ++digits;
    std::size_t first = kMaxDigits;
    while (first < kMaxImplicitDigits && kTolerance[first] > kLooser * wanted) ++first;
    for (std::size_t i = first; i < first + kImplicitTrials && i <= kMaxImplicitDigits; ++i) {
        if (!implicit_pays(system, system.bodies.front(), world, kTolerance[i])) break;
        Trial& trial = trials.emplace_back();
        trial.method = ExactDef{kTolerance[i], true};
        trial.check = ExactDef{kImplicitCheck * kTolerance[i], true};
    }
    for (;; digits = std::min(digits + kNextDigits, tightest.run)) {
        Trial& trial = trials.emplace_back();
        trial.method = ExactDef{kTolerance[digits]};
        trial.check = ExactDef{
            kTolerance[std::min(digits + (is_rigid_net ? kNetCheckDigits : kCheckDigits), tightest.check)]};
        if (digits == tightest.run) return trials;
    }
}

/// Trials of `rattle` for a graph, each checked by the next order (8 by 8) at kCheckStep of its step.
std::vector<Trial> graph_trials(const System& system, const WorldDef& world, const PlanDef& def) {
    const std::int64_t none_done = 0;
    const CancelScope progress = report_frames(def, none_done);
    std::vector<Trial> trials;
    int order = 0;
    double stable_s = 0.0;
    for (const Rung& rung : kGraphLadder) {
        if (rung.order != order) {  // a large net takes seconds to prepare
            order = rung.order;
            stable_s = Rattle(system, world, RattleDef{order}, kNominalIntervalSeconds).step_s();
        }
        const double step_s = stable_s / static_cast<double>(1 << rung.halvings);
        Trial& trial = trials.emplace_back();
        trial.method = RattleDef{rung.order, step_s};
        trial.check = RattleDef{std::min(rung.order + 2, RattleDef::kOrders.back()), kCheckStep * step_s,
                                kCheckStep * RattleDef{}.guard};
    }
    return trials;
}

/// True if two trials in a row diverged or were undecided at the same time: a finer trial would be too.
bool give_up_together(const Trial& a, const Trial& b) {
    return ((a.diverged && b.diverged) || (a.undecided && b.undecided)) && a.reached_s == b.reached_s;
}

/// A horizon before this share of the motion is not worth the tightest method's cost.
constexpr double kEarly = 0.1;

/// Upper bound of the factor by which a trial a hundred times tighter reaches farther if errors grow
/// exponentially: the time at which the last trial reached its tolerance over that of a hundredth of it.
/// Infinite if unknown, or if even the tightest trial would end so early that another one must decide.
double farther(const System& system, const Trial& last, std::size_t left, double end_s) {
    if (!std::holds_alternative<ExactDef>(last.method) || has_kinks(system) || last.hundredth_s == 0.0)
        return HUGE_VAL;
    const double factor = last.reached_s / last.hundredth_s;
    double tightest_s = last.reached_s;
    for (std::size_t i = 0; i < left; ++i) tightest_s *= factor;
    return tightest_s < kEarly * end_s ? HUGE_VAL : factor;
}

/// Time by which the last trial reached farther than its looser predecessor; std::nullopt without one.
std::optional<double> gain_s(const BodyPlan& plan) {
    const std::size_t ran = plan.trials.size();
    if (ran < 2 || is_implicit(plan.trials[ran - 2].method)) return std::nullopt;
    return plan.trials[ran - 1].reached_s - plan.trials[ran - 2].reached_s;
}

/// The trial to run after number `failed`. Skips those that would not reach the end either: errors of chaotic
/// motions grow exponentially, so each trial gains about as much time as its predecessor.
std::size_t next_trial(const System& system, const BodyPlan& plan, std::size_t failed, std::size_t count,
                       double end_s) {
    const Trial& last = plan.trials.back();
    const double gained_s = gain_s(plan).value_or(HUGE_VAL);
    const double factor = farther(system, last, count - 1 - failed, end_s);
    const auto later_s = [&](double reached_s) { return std::min(reached_s + gained_s, reached_s * factor); };
    std::size_t next = failed + 1;
    for (double hoped_s = later_s(last.reached_s); next + 1 < count && hoped_s < end_s; ++next)
        hoped_s = later_s(hoped_s);
    return next;
}

/// True if even the tightest trial is not expected to predict a tenth of the motion and so is not worth its
/// cost: the failed trial is used, unless it is so loose that its energy visibly drifts.
bool can_tell_little(const BodyPlan& plan, std::size_t failed, std::size_t count, double end_s) {
    constexpr double kLooseTolerance = 1e-6;
    constexpr std::size_t kRungs = 3;  // of `rattle`: orders 2 and 4 say little of 6 and 8
    const auto* exact = std::get_if<ExactDef>(&plan.trials.back().method);
    const std::optional<double> gained_s = gain_s(plan);
    if (!gained_s || (exact == nullptr && plan.trials.size() < kRungs) ||
        (exact != nullptr && exact->tolerance > kLooseTolerance))
        return false;
    return plan.trials.back().reached_s + static_cast<double>(count - 1 - failed) * std::max(0.0, *gained_s) <
           kEarly * end_s;
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

bool is_rigid_graph(const Body& body) {
    return !body.is_chain && body.material.compliance_1_n == 0.0 && !body.material.is_string;
}

/// Runs the trials, cheapest first, until one holds to the end, and makes it or the last one the plan. Ends
/// at the first trial of `exact` that diverges for a graph of rigid bars: they have come into line.
void run_until_one_holds(const System& system, const WorldDef& world, const PlanDef& def,
                         std::vector<Trial> trials, BodyPlan& plan, Recording& recording) {
    const double end_s = def.timeline.time_s(def.timeline.size() - 1);
    const auto next = [&](std::size_t failed) {
        // Implicit ones are cheap and say little of explicit ones.
        if (is_implicit(trials[failed].method)) return failed + 1;
        return next_trial(system, plan, failed, trials.size(), end_s);
    };
    for (std::size_t i = 0;; i = next(i)) {
        TrialKind kind{i == 0, i + 1 == trials.size()};
        if (is_implicit(trials[i].method))
            kind.most_steps_1_s = most_implicit_steps_1_s(system, system.bodies.front(), world);
        plan.method = trials[i].method;
        run_trial(system, world, def, kind, trials[i], recording, plan.passes);
        plan.trials.push_back(trials[i]);
        const std::size_t count = plan.trials.size();
        const bool is_in_line = trials[i].diverged && std::holds_alternative<ExactDef>(trials[i].method) &&
                                is_rigid_graph(system.bodies.front());
        if (trials[i].to_the_end || kind.is_last || is_in_line) break;
        const bool gives_up = can_tell_little(plan, i, trials.size(), end_s) ||
                              (count > 1 && give_up_together(plan.trials[count - 2], trials[i]));
        if (!gives_up || is_implicit(trials[i].method)) continue;
        record(system, world, def, plan, recording);
        plan.trials.back().steps = recording.diagnostics().steps;
        break;
    }
    const Trial& chosen = plan.trials.back();
    plan.error_estimate_m = chosen.error_estimate_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    plan.undecided = chosen.undecided;
    plan.diverges = recording.size() < def.timeline.size();
}

/// Makes `relaxation` the plan, without an estimate of its error, with enough sweeps to keep a cloth of some
/// thirty rows from sagging like rubber.
void fall_back(const System& system, const WorldDef& world, const PlanDef& def, BodyPlan& plan,
               Recording& recording) {
    constexpr int kSweeps = 8;
    constexpr double kSteps = 4.0;  // in the nominal interval
    plan.method = RelaxationDef{kNominalIntervalSeconds / kSteps, kSweeps};
    plan.error_estimate_m = std::nullopt;
    plan.horizon_s = std::nullopt;
    plan.diverges = false;
    plan.reason = PlanReason::kDependent;
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
    const auto pins = std::ranges::count(system.inverse_mass_1_kg, 0.0);
    if (!body.is_net || body.material.compliance_1_n > 0.0 || pins < 2) return StandsStill::kNo;
    MotionBounds start;
    start.include({0.0, system.x_m, system.y_m});
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
    if (!exact_refusal) {
        plan.reason = PlanReason::kExact;
        MotionBounds start;
        start.include({0.0, system.x_m, system.y_m});
        run_until_one_holds(system, world, def, exact_trials(system, world, def.tolerance_m(start)), plan,
                            recording);
        const bool is_in_line = plan.trials.back().diverged && is_rigid_graph(system.bodies.front());
        if (!is_in_line || refusal_of(RattleDef{})) return plan;
        // `rattle` passes lines of bars.
        const BodyPlan stopped = std::move(plan);
        plan = {};
        plan.passes = stopped.passes;
        plan.reason = PlanReason::kGraph;
        run_until_one_holds(system, world, def, graph_trials(system, world, def), plan, recording);
        plan.trials.insert(plan.trials.begin(), stopped.trials.begin(), stopped.trials.end());
        return plan;
    }
    if (is_rigid_chain(system.bodies.front()) ||
        exact_refusal->reason() == Refusal::Reason::kBarWithoutLength)
        throw Refusal(*exact_refusal);
    const bool can_fall_back = !refusal_of(RelaxationDef{});
    if (const auto rattle_refusal = refusal_of(RattleDef{})) {
        if (!can_fall_back) throw Refusal(*rattle_refusal);
        fall_back(system, world, def, plan, recording);
        return plan;
    }
    plan.reason = PlanReason::kGraph;
    try {
        run_until_one_holds(system, world, def, graph_trials(system, world, def), plan, recording);
    } catch (const Refusal&) {
        // A check, whose start is turned, may take bars to depend on each other that the run does not.
        if (!can_fall_back) throw;
        fall_back(system, world, def, plan, recording);
    }
    return plan;
}

Plan plan_methods(const System& system, const NamedMethods& named, const WorldDef& world, const PlanDef& def,
                  Recording& recording) {
    Plan plan;
    MotionBounds known;
    known.include({0.0, system.x_m, system.y_m});
    const auto count = static_cast<std::int64_t>(system.bodies.size());
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
        const auto plan_into = [&](Recording& own) {
            BodyPlan& made =
                plan.bodies.emplace_back(named[i] ? record_named(body, world, of_body, *named[i], own)
                                                  : plan_body(body, world, of_body, own));
            if (made.reason != PlanReason::kNamed) made.stands_still = why_still(body, own);
            known.include(own.bounds());
        };
        if (count == 1) return plan_into(recording);
        Recording part = recording.for_part(body.particle_count(), body.bars.size());
        plan_into(part);
        recording.add_body(part, system.bodies[i].first_particle, system.bodies[i].first_bar);
    });
    sum_up(system, plan);
    return plan;
}

}  // namespace corda::sim
