#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/timeline.hpp"
#include "support/nets.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

/// The first trial of a plan, and perhaps the last.
TrialKind kind_of(bool is_last) {
    TrialKind kind;
    kind.is_last = [is_last](const Trial&, double, double) { return is_last; };
    return kind;
}

const FrameRate kTrialFrames(Rational{60, 1});

struct Outcome {
    Trial trial;
    std::size_t states = 0;
};

Trial trial_of(const MethodDef& method, const MethodDef& check) {
    Trial trial;
    trial.method = method;
    trial.check = check;
    return trial;
}

/// A trial of one second.
Outcome outcome_of(const RopeDef& rope, const MethodDef& method, const MethodDef& check, double tolerance_m,
                   const TrialKind& kind = kind_of(false), const OnProgress& on_progress = {}) {
    const System system = build_system({&rope, 1});
    const auto tolerance = [tolerance_m](const MotionBounds&) { return tolerance_m; };
    Recording recording(system.particle_count(), 61);
    Outcome outcome;
    outcome.trial = run_trial(system, WorldDef{}, {tolerance, Timeline(kTrialFrames, 60), on_progress, {}},
                              kind, trial_of(method, check), recording);
    outcome.states = recording.size();
    return outcome;
}

TEST(Trial, ToTheEndIsAPassOfTheRunAndOneOfItsCheck) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 60.0);
    const Outcome outcome = outcome_of(rope, ExactDef{1e-6}, ExactDef{1e-8}, 1e-3);
    EXPECT_TRUE(outcome.trial.to_the_end);
    EXPECT_FALSE(outcome.trial.diverged);
    EXPECT_EQ(outcome.trial.reached_s, 1.0);
    EXPECT_GT(outcome.trial.largest_difference_m, 0.0);
    EXPECT_LT(outcome.trial.largest_difference_m, 1e-5);
    EXPECT_GT(outcome.trial.check_steps, outcome.trial.steps);
    EXPECT_EQ(outcome.trial.passes, 2);
    EXPECT_EQ(outcome.states, 61U);
}

TEST(Trial, EndsAtTheFirstLargeDifferenceUnlessItsRunIsDrawn) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 60.0);
    const MethodDef coarse = RattleDef{2, 1.0 / 60.0};
    for (const bool is_last : {false, true}) {
        const Outcome outcome = outcome_of(rope, coarse, ExactDef{1e-10}, 1e-6, kind_of(is_last));
        EXPECT_FALSE(outcome.trial.to_the_end);
        EXPECT_LT(outcome.trial.reached_s, 0.5);
        EXPECT_LE(3.0 * outcome.trial.largest_difference_m, 1e-6);
        EXPECT_EQ(outcome.states == 61, is_last);
        EXPECT_EQ(outcome.trial.passes, 2);
    }
}

TEST(Trial, HasThreeChecksWhereRoundingMatters) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 120.0);
    EXPECT_EQ(outcome_of(rope, ExactDef{1e-8}, ExactDef{1e-10}, 1e-3).trial.passes, 2);
    // These round at 1e-12; the starts of the second and the third are rounded otherwise, too.
    EXPECT_EQ(outcome_of(rope, ExactDef{1e-10}, ExactDef{1e-12}, 1e-3).trial.passes, 4);
    const auto of_order = [&rope](int order) {
        return outcome_of(rope, RattleDef{order, 0.01}, RattleDef{order, 0.01}, 1e-3).trial;
    };
    EXPECT_EQ(of_order(2).passes, 2);
    EXPECT_EQ(of_order(8).passes, 4);
}

TEST(Trial, HasASecondCheckWhereImplicitStepsMayMissBuckling) {
    RopeDef bridge = reference::straight_rope(40, 1.0, 90.0);
    for (Vec2& point : bridge.points_m) point.y = 0.5 * point.x * (point.x - 1.0);
    bridge.pinned = {0, 40};
    const MethodDef run = ExactDef{1e-4, true};
    const MethodDef check = ExactDef{2.5e-5, true};
    EXPECT_EQ(outcome_of(bridge, run, check, 1e-3).trial.passes, 2);
    bridge.material.compliance_1_n = 1e-4;
    EXPECT_EQ(outcome_of(bridge, run, check, 1e-3).trial.passes, 3);
    bridge.pinned = {0};
    EXPECT_EQ(outcome_of(bridge, run, check, 1e-3).trial.passes, 2);
}

/// A trial of a pendulum that turns back every half second.
Trial swinging(const Timeline& timeline, double end_s = 0.0) {
    const RopeDef rope = reference::straight_rope(1, 1.0, 60.0);
    const System system = build_system({&rope, 1});
    const WorldDef world{{0.0, -4.0 * 11.367017035003174}};
    Recording recording(system.particle_count(), timeline.size());
    Trial trial;
    trial.method = ExactDef{1e-6};
    trial.check = ExactDef{1e-10};
    trial = run_trial(system, world, {[](const MotionBounds&) { return 1.0; }, timeline, {}, {}, end_s},
                      {true}, trial, recording);
    EXPECT_TRUE(trial.to_the_end);
    return trial;
}

TEST(Trial, ComparesBetweenFramesThatAreSparse) {
    const double often_m = swinging(Timeline(kTrialFrames, 6000)).largest_difference_m;
    for (const std::int64_t frames_per_s : {1, 2, 4}) {
        const Timeline sparse(FrameRate(Rational{frames_per_s, 1}), 100 * frames_per_s);
        EXPECT_GT(swinging(sparse).largest_difference_m, 0.5 * often_m) << frames_per_s;
    }
}

TEST(Trial, ComparesAfterTheLastFrame) {
    const Timeline one_frame(FrameRate(Rational{1, 100}), 0);
    EXPECT_LT(swinging(one_frame).largest_difference_m, 1e-15);
    const double often_m = swinging(Timeline(kTrialFrames, 600)).largest_difference_m;
    const Trial trial = swinging(one_frame, 10.0);
    EXPECT_GT(trial.largest_difference_m, 0.8 * often_m);
    EXPECT_EQ(trial.reached_s, 0.0);  // the only frame
}

TEST(Trial, DoesNotDependOnOtherTimesThatAreRecorded) {
    const FrameRate rate(Rational{1, 1});
    const Trial plain = swinging(Timeline(rate, 10));
    const Trial recorded = swinging(Timeline(rate, 10, {0.25, 3.1, 3.2, 3.3, 9.99}));
    EXPECT_EQ(recorded.largest_difference_m, plain.largest_difference_m);
    EXPECT_EQ(recorded.steps, plain.steps);
}

TEST(Trial, EstimateIncludesTheRoundingOfFarPositions) {
    RopeDef rope = reference::straight_rope(2, 1.0, 30.0);
    rope.origin_m = {1e8, 0.0};
    const Outcome outcome = outcome_of(rope, ExactDef{1e-8}, ExactDef{1e-10}, 1.0);
    EXPECT_GT(outcome.trial.error_estimate_m, 1.4e-8);  // an ulp there is 1.5e-8
    EXPECT_LT(outcome.trial.error_estimate_m, 1e-7);
}

TEST(Trial, EstimateIncludesHiddenVibrations) {
    // Two links of 5 cm as stiff as a beam: run and check take the same steps and damp what vibrates.
    RopeDef beam = reference::straight_rope(2, 0.1, 2.0);
    beam.bending_n_m2 = 625.0;
    const Outcome outcome = outcome_of(beam, ExactDef{1e-4}, ExactDef{1e-6}, 1e-3);
    EXPECT_TRUE(outcome.trial.to_the_end);
    EXPECT_GE(outcome.trial.error_estimate_m, 1e-6 * 0.1);
}

/// A particle that falls from between two pins until links of these lengths stop it, after 0.46 s.
RopeDef caught(double left_m, double right_m) {
    RopeDef rope = test::string_of({{-0.6, 0.0}, {0.0, 0.0}, {0.6, 0.0}}, {left_m, right_m});
    rope.pinned = {0, 2};
    return rope;
}

TEST(Trial, EndsWhereRoundingDecidesWhichLinkSnapsFirst) {
    const Outcome equal = outcome_of(caught(1.2, 1.2), ExactDef{1e-5}, ExactDef{1e-9}, 1e-3);
    EXPECT_FALSE(equal.trial.to_the_end);
    EXPECT_TRUE(equal.trial.undecided);
    EXPECT_EQ(equal.trial.reached_s, 27.0 / 60.0);
    EXPECT_EQ(equal.trial.passes, 4);
    const Outcome unequal = outcome_of(caught(1.2, 1.2 + 1.2e-11), ExactDef{1e-5}, ExactDef{1e-9}, 1e-3);
    EXPECT_TRUE(unequal.trial.to_the_end);
    EXPECT_FALSE(unequal.trial.undecided);
    EXPECT_EQ(unequal.trial.passes, 2);
}

TEST(Trial, CoversBothOutcomesOfALinkThatBarelySnaps) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.3, 0.2}}, {1.0});
    rope.velocity_m_s[1] = {0.0, 3.8460742493873763};  // its distance is 1 m at the top
    for (const double tolerance_m : {1e-3, 1e-9}) {
        const Outcome outcome = outcome_of(rope, ExactDef{1e-5}, ExactDef{1e-9}, tolerance_m);
        EXPECT_EQ(outcome.trial.to_the_end, tolerance_m == 1e-3);
        EXPECT_EQ(outcome.trial.undecided, tolerance_m == 1e-9);
        EXPECT_EQ(outcome.trial.passes, 4);
        if (outcome.trial.to_the_end) {
            EXPECT_GT(outcome.trial.error_estimate_m, 2e-7);
        }  // what the snap changes
    }
}

TEST(Trial, ThatDivergesAtItsStartIsOnePass) {
    // Farther apart than positions may be: the run gives up at once, and its check never moves.
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {1e13, 0.0}});
    const Outcome outcome = outcome_of(rope, RelaxationDef{}, RelaxationDef{}, 1.0);
    EXPECT_TRUE(outcome.trial.diverged);
    EXPECT_FALSE(outcome.trial.to_the_end);
    EXPECT_EQ(outcome.trial.passes, 1);
    EXPECT_EQ(outcome.states, 0U);
}

TEST(Trial, CanBeStopped) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 60.0);
    const OnProgress stop = [](std::int64_t done, std::int64_t) { return done < 5; };
    try {
        static_cast<void>(outcome_of(rope, ExactDef{1e-6}, ExactDef{1e-8}, 1e-3, kind_of(false), stop));
        ADD_FAILURE() << "not stopped";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
}

TEST(RefusalOfAMethod, HasItsReason) {
    RopeDef ring = test::ring(5);
    ring.bending_n_m2 = 1.0;
    const System system = build_system({&ring, 1});
    EXPECT_EQ(refusal(system, WorldDef{}, ExactDef{}, 0.01).value().reason(), Refusal::Reason::kRigidGraph);
    EXPECT_FALSE(refusal(system, WorldDef{}, RattleDef{}, 0.01).has_value());
}

TEST(Checks, RepeatARunOfFixedStepsThatIsNearRounding) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 60.0);
    const System system = build_system({&rope, 1});
    const auto of = [&](const MethodDef& method, const MethodDef& check) {
        return checks_of(system, trial_of(method, check));
    };
    using Methods = std::vector<MethodDef>;
    const ExactDef tight{1e-13};
    EXPECT_EQ(of(ExactDef{1e-8}, tight), Methods{tight});
    EXPECT_EQ(of(ExactDef{1e-9}, tight), (Methods{tight, tight, tight}));
    const RattleDef check{6, 1e-4};
    const RattleDef run{4, 3e-4};
    EXPECT_EQ(of(RattleDef{2, 3e-4}, check), Methods{check});
    EXPECT_EQ(of(run, check), (Methods{check, run, run}));

    // What runs of one method differ by counts twice: rounding, here far less than the error.
    Checks checks(system, WorldDef{}, trial_of(run, check), 1.0 / 60.0);
    Simulation alike(system, WorldDef{}, run);
    ASSERT_EQ(alike.advance_to(0.3), Status::kOk);
    checks.start(0.3);
    ASSERT_EQ(checks.finish(), Status::kOk);
    const double error_m = checks.difference_m(alike.state());
    Simulation truth(system, WorldDef{}, tight);
    ASSERT_EQ(truth.advance_to(0.3), Status::kOk);
    double largest_m = 0.0;
    for (std::size_t i = 0; i < system.particle_count(); ++i)
        largest_m = std::max(largest_m, length(alike.state().x_m[i] - truth.state().x_m[i],
                                               alike.state().y_m[i] - truth.state().y_m[i]));
    EXPECT_NEAR(error_m, largest_m, 0.01 * largest_m);
    State moved = alike.state();
    constexpr double kMoved = 1e-3;
    moved.x_m.back() += kMoved;  // as if by rounding
    EXPECT_NEAR(checks.difference_m(moved), 3.0 * kMoved, 0.1 * kMoved);
}

/// Of a rope that swings, in one thread (5 links) and in several (120).
class ChecksOfARope : public testing::TestWithParam<int> {
  protected:
    const RopeDef rope_ = reference::straight_rope(GetParam(), 1.0, 60.0);
    const System system_ = build_system({&rope_, 1});
};

TEST_P(ChecksOfARope, AreNearALooserRun) {
    Checks checks(system_, WorldDef{}, trial_of(ExactDef{1e-9}, ExactDef{1e-12}), 1.0 / 60.0);
    Checks one(system_, WorldDef{}, trial_of(ExactDef{1e-8}, ExactDef{1e-12}), 1.0 / 60.0);
    ASSERT_EQ(checks.size(), 3U);
    ASSERT_EQ(one.size(), 1U);
    Simulation run(system_, WorldDef{}, ExactDef{1e-8});
    for (const double time_s : {0.1, 0.2, 0.3}) {
        checks.start(time_s);
        one.start(time_s);
        ASSERT_EQ(run.advance_to(time_s), Status::kOk);
        ASSERT_EQ(checks.finish(), Status::kOk);
        ASSERT_EQ(one.finish(), Status::kOk);
        EXPECT_GT(checks.difference_m(run.state()), one.difference_m(run.state()));
        EXPECT_GT(checks.difference_m(run.state()), 1e-15);  // 3e-13 to 5e-11 m
        EXPECT_LT(checks.difference_m(run.state()), 1e-9);
    }
    EXPECT_GT(checks.steps(), run.diagnostics().steps);
}

TEST_P(ChecksOfARope, CallGoesOnOnlyInTheCallersThread) {
    const auto caller = std::this_thread::get_id();
    bool is_asked = false;
    const CancelScope never([&] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        return !std::exchange(is_asked, true);
    });
    Checks checks(system_, WorldDef{}, trial_of(ExactDef{1e-9}, ExactDef{1e-12}), 1.0 / 60.0);
    is_asked = true;
    checks.start(30.0);  // a second of work or more
    try {
        static_cast<void>(checks.finish());
        ADD_FAILURE() << "the callback was not called";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
}

TEST_P(ChecksOfARope, EndWithTheirOwner) {
    Checks checks(system_, WorldDef{}, trial_of(ExactDef{1e-9}, ExactDef{1e-12}), 1.0 / 60.0);
    checks.start(1e6);
    EXPECT_EQ(checks.steps(), 0U);  // of the last finish(), whatever a thread has done since
}

INSTANTIATE_TEST_SUITE_P(Links, ChecksOfARope, testing::Values(5, 120));

}  // namespace
}  // namespace corda::sim
