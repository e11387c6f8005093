#include "corda/sim/auto/tolerances.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <variant>

#include "corda/core/cancel.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/exact/elastic_dynamics.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Tolerances of `exact` are powers of ten: a preview at another size, whose pixels are of nearly the same
/// size, shows the same bits. They are denoted by their digits.
constexpr std::array<double, 16> kTolerance{1.0,  1e-1, 1e-2,  1e-3,  1e-4,  1e-5,  1e-6,  1e-7,
                                            1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15};
constexpr std::size_t kLoosestDigits = 3;
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
/// Of what the rounding of positions makes of the forces of stiff bars, which steps cannot get below: shares
/// of a rounding, per ratio of the frequencies of a bar and of the body. 1000 links of 1 m in all, 1 g each
/// and 1e-3 1/N take 15 times as many steps at 1e-11 as at 1e-10, and 100 of 1e-4 1/N 250 times as many at
/// 1e-12 as at 1e-11.
constexpr double kRoundingOfForces = 5.0;

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

/// Trials with implicit steps, which long or stiff ropes have, are each ten times tighter than the last.
/// Positions err by about the tolerance, so a check at a quarter of it shows three quarters of the error,
/// in 1.6 times as many steps.
constexpr std::size_t kImplicitTrials = 3;
constexpr std::size_t kMaxImplicitDigits = 7;
constexpr double kLooser = 2.0;               ///< errors are 0.05 to 0.4 of the tolerance
constexpr double kLooserIfStretching = 1.25;  ///< up to 0.8 of it as a rule
constexpr double kImplicitCheck = 0.25;
constexpr double kStepsOfImplicitCheck = 1.6;  ///< in parts of the run's
constexpr double kMoreThanExplicit = 1.5;      ///< steps that they may take, because their checks are cheaper
/// Work that an explicit step counts, by implicit ones, and how many more of them each digit takes.
constexpr double kWorkOfExplicit = 1.75;
constexpr double kMorePerDigit = 1.25;

TightestDigits tightest_digits(const System& system, const WorldDef& world) {
    TightestDigits tightest = has_kinks(system) ? kWithKinks : kSmooth;
    if (system.bodies.front().material.compliance_1_n == 0.0) return tightest;
    const ElasticDynamics body(system, world);
    const double least = kRoundingOfForces * std::numeric_limits<double>::epsilon() * body.frequency_1_s() /
                         body.inverse_timescale_1_s();
    for (; tightest.run > kLoosestDigits && kTolerance[tightest.check] < least; --tightest.run)
        --tightest.check;
    return tightest;
}

/// The step that `rattle` of an order takes by default.
double default_step_s(const System& system, const WorldDef& world, int order) {
    const MethodDef rattle = RattleDef{order};
    if (!system.has_events())
        return Rattle(system, world, RattleDef{order}, kNominalIntervalSeconds).step_s();
    const auto solver = make_solver(system, world, {&rattle, 1}, kNominalIntervalSeconds);
    return fixed_step_s(solver->methods().front()).value_or(kNominalIntervalSeconds);
}

/// Stages of `rattle` of an order in a step.
double stages_of(int order) {
    return static_cast<double>(composition(order).stages.size());
}

/// `check_effort`: of its check alone.
Candidate candidate(const System& system, const MethodDef& method, const MethodDef& check, double effort,
                    double check_effort, int digits) {
    Candidate made{{}, effort, 0.0, digits};
    made.trial.method = method;
    made.trial.check = check;
    for (const MethodDef& one : checks_of(system, made.trial))
        made.checks_effort += one == check ? check_effort : effort;
    return made;
}

/// Order of `rattle` that is tried first for nets that stretch: stability limits its steps and those of
/// `exact` alike, which err far less.
constexpr int kCheapOrder = 2;
/// Work of its run in parts of that of `exact`.
constexpr double kCheapEffort = 0.4;
/// Steps of all particles in its run up to which it is not tried: some 10 ms.
constexpr double kTooCheap = 6e5;
/// Where strings come taut, errors of `exact` are of order 2 as well, and each kink costs several steps:
/// cloths of 15 x 15 to 50 x 50 strings take 60 to 200 times as long at 1e-7 as by order 2 of `rattle`. So
/// `rattle` is tried first, with this many step sizes, each a third of the last.
constexpr int kTrialsWithKinks = 4;
constexpr double kCheapEffortWithKinks = 0.01;

/// Adds the trials that come before those of `exact`, with these digits and more.
void add_cheap_trials(std::vector<Candidate>& trials, const System& system, double step_s,
                      double check_tolerance, int digits) {
    if (!has_kinks(system)) {
        trials.push_back(candidate(system, RattleDef{kCheapOrder, step_s}, ExactDef{check_tolerance},
                                   kCheapEffort, 1.0, digits));
        return;
    }
    double share = 1.0;
    for (int i = 0; i < kTrialsWithKinks; ++i, share *= kCheckStep) {
        const double effort = kCheapEffortWithKinks / share;
        trials.push_back(candidate(system, RattleDef{kCheapOrder, share * step_s},
                                   RattleDef{kCheapOrder, kCheckStep * share * step_s}, effort,
                                   effort / kCheckStep, digits + i));
    }
}

}  // namespace

bool is_implicit(const MethodDef& method) {
    const auto* exact = std::get_if<ExactDef>(&method);
    return exact != nullptr && exact->implicit;
}

bool has_kinks(const System& system) {
    return std::ranges::any_of(system.bodies, [](const Body& body) {
        return body.material.is_string && body.material.compliance_1_n > 0.0;
    });
}

ExactDef loosest_exact() {
    return {kTolerance[kLoosestDigits]};
}

std::vector<Candidate> exact_trials(const System& system, const WorldDef& world, double tolerance_m,
                                    double end_s) {
    std::vector<Candidate> trials;
    const TightestDigits tightest = tightest_digits(system, world);
    // The links of a net are many times as long as its way from end to end.
    const Body& body = system.bodies.front();
    const MotionBounds start = whole_bounds_of_start(system);
    const Vec2 extent = start.max_m() - start.min_m();
    const bool is_net = !moves_as_chains(system, body);
    const bool is_rigid_net = is_net && body.material.compliance_1_n == 0.0;
    const double wanted = tolerance_m / (is_net ? extent.x + extent.y : largest_length_m(system));
    std::size_t digits = kLoosestDigits;
    while (digits < tightest.run && kTolerance[digits] > wanted) ++digits;
    const double looser = body.material.compliance_1_n > 0.0 ? kLooserIfStretching : kLooser;
    std::size_t first = kLoosestDigits;
    while (first < kMaxImplicitDigits && kTolerance[first] > looser * wanted) ++first;
    const double explicit_1_s = most_implicit_steps_1_s(system, body, world);
    for (std::size_t i = first; i < first + kImplicitTrials && i <= kMaxImplicitDigits; ++i) {
        const double steps_1_s =
            explicit_1_s > 0.0 ? implicit_steps_1_s(system, body, world, kTolerance[i]) : 0.0;
        if (!(steps_1_s < explicit_1_s)) break;
        trials.push_back(candidate(system, ExactDef{kTolerance[i], true},
                                   ExactDef{kImplicitCheck * kTolerance[i], true}, steps_1_s,
                                   kStepsOfImplicitCheck * steps_1_s, static_cast<int>(i)));
        trials.back().most_steps_1_s = kMoreThanExplicit * explicit_1_s;
    }
    if (is_net && !is_rigid_net && !refusal(system, world, RattleDef{kCheapOrder}, kNominalIntervalSeconds)) {
        const double step_s = default_step_s(system, world, kCheapOrder);
        if (end_s / step_s * static_cast<double>(system.particle_count()) > kTooCheap) {
            const auto cheap_digits = static_cast<int>(digits);
            // Stability limits the steps of both: `exact` costs no more at a tolerance that errs less.
            digits = std::min(digits + kNextDigits, tightest.run);
            add_cheap_trials(trials, system, step_s, kTolerance[digits], cheap_digits);
        }
    }
    const bool has_implicit = !trials.empty() && is_implicit(trials.front().trial.method);
    double effort = has_implicit ? kWorkOfExplicit * explicit_1_s : 1.0;
    const double more = has_implicit ? kMorePerDigit * kMorePerDigit : 1.0;
    for (;; digits = std::min(digits + kNextDigits, tightest.run), effort *= more) {
        const std::size_t check =
            std::min(digits + (is_rigid_net ? kNetCheckDigits : kCheckDigits), tightest.check);
        const double check_effort = eighth_root(kTolerance[digits] / kTolerance[check]) * effort;
        trials.push_back(candidate(system, ExactDef{kTolerance[digits]}, ExactDef{kTolerance[check]}, effort,
                                   check_effort, static_cast<int>(digits)));
        if (digits == tightest.run) return trials;
    }
}

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
        const int check_order = std::min(rung.order + 2, RattleDef::kOrders.back());
        trials.push_back(
            candidate(system, RattleDef{rung.order, step_s},
                      RattleDef{check_order, kCheckStep * step_s, kCheckStep * RattleDef{}.guard},
                      stages_of(rung.order) / step_s, stages_of(check_order) / (kCheckStep * step_s),
                      kDigits * static_cast<int>(trials.size())));
    }
    return trials;
}

}  // namespace corda::sim
