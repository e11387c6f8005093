#include "corda/sim/auto/planner.hpp"

#include <array>

#include <gtest/gtest.h>

#include "benchmark/study/reference/ropes.hpp"
#include "support/nets.hpp"
#include "support/plan_of.hpp"

namespace corda::sim {
namespace {

using Reason = Refusal::Reason;

const FrameRate kFrames(Rational{60, 1});

/// The plan for one rope, which has to be within `tolerance_m` up to a frame.
BodyPlan plan_of(const RopeDef& rope, double tolerance_m, std::int64_t last_frame) {
    return test::plan_of(build_system({&rope, 1}), WorldDef{}, tolerance_m, kFrames, last_frame);
}

/// Why there is no plan for a system.
std::optional<Reason> refusal_of(const System& system) {
    try {
        static_cast<void>(test::plan_of(system, WorldDef{}, 1e-3, kFrames, 10));
    } catch (const Refusal& refusal) {
        return refusal.reason();
    }
    return std::nullopt;
}

TEST(AutoPlan, TakesALooserMethodForALooserTolerance) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    const BodyPlan loose = plan_of(rope, 1e-3, 120);
    const BodyPlan tight = plan_of(rope, 1e-9, 120);
    EXPECT_GT(std::get<ExactDef>(loose.method).tolerance, std::get<ExactDef>(tight.method).tolerance);
    EXPECT_LT(loose.trials.back().steps, tight.trials.back().steps);
}

TEST(AutoPlan, IsTheSameOnEveryRun) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    const BodyPlan a = plan_of(rope, 1e-4, 300);
    const BodyPlan b = plan_of(rope, 1e-4, 300);
    EXPECT_EQ(std::get<ExactDef>(a.method).tolerance, std::get<ExactDef>(b.method).tolerance);
    EXPECT_EQ(a.error_estimate_m, b.error_estimate_m);
    EXPECT_EQ(a.horizon_s, b.horizon_s);
}

TEST(AutoPlan, CountsTheRunsAndTheChecksOfAllTrials) {
    const BodyPlan plan = plan_of(reference::straight_rope(10, 1.0, 90.0), 1e-4, 300);
    ASSERT_GT(plan.trials.size(), 1U);
    // Two of each trial, and four of the tightest, which has three checks.
    EXPECT_EQ(plan.passes, 2 * static_cast<int>(plan.trials.size()) + 2);
    EXPECT_EQ(plan.reason, PlanReason::kExact);
}

TEST(AutoPlan, ChecksEachTrialFarMoreTightly) {
    const BodyPlan plan = plan_of(reference::straight_rope(10, 1.0, 90.0), 1e-4, 300);
    const auto tolerance = [](const MethodDef& method) { return std::get<ExactDef>(method).tolerance; };
    for (const Trial& trial : plan.trials)
        EXPECT_LE(tolerance(trial.check), std::max(1.01e-4 * tolerance(trial.method), 1e-12));
}

TEST(AutoPlan, GivesAClosedRopeExactAndOneThatResistsBendingRattle) {
    for (RopeDef ring : {test::ring(5), test::free_ring(5)})
        EXPECT_EQ(plan_of(ring, 1e-2, 10).reason, PlanReason::kExact);
    RopeDef ring = test::ring(5);
    ring.bending_n_m2 = 1e-2;
    const BodyPlan plan = plan_of(ring, 1e-2, 10);
    EXPECT_TRUE(std::holds_alternative<RattleDef>(plan.method));
    EXPECT_EQ(plan.reason, PlanReason::kGraph);
    EXPECT_LE(plan.error_estimate_m.value(), 1e-2);
}

TEST(AutoPlan, GivesRigidNetsExact) {
    for (const bool diagonals : {false, true}) {
        NetDef net = test::leaning_net(6, 5, 0.2, diagonals);
        const BodyPlan plan = test::plan_of(build_system({}, {&net, 1}), WorldDef{}, 1e-3, kFrames, 60);
        EXPECT_TRUE(std::holds_alternative<ExactDef>(plan.method));
        EXPECT_EQ(plan.reason, PlanReason::kExact);
        EXPECT_LE(plan.error_estimate_m.value(), 1e-3);
        net.points_m[9].x += 0.01;
        const BodyPlan other = test::plan_of(build_system({}, {&net, 1}), WorldDef{}, 1e-3, kFrames, 60);
        EXPECT_TRUE(std::holds_alternative<ExactDef>(other.method));
        EXPECT_LE(other.error_estimate_m.value(), 1e-3);
    }
}

TEST(AutoPlan, PassesALineOfBarsByRattle) {
    // A grid of squares with a hole, on a corner: its cells come into line at 0.48 s, which `exact` passes
    // only without the hole.
    constexpr std::uint32_t kSide = 5;
    constexpr std::uint32_t kHole = 12;
    NetDef net;
    const auto number = [](std::uint32_t i) { return i < kHole ? i : i - 1; };
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        if (i == kHole) continue;
        net.points_m.push_back({0.25 * (i % kSide), -0.25 * (i / kSide)});
        if (i % kSide > 0 && i - 1 != kHole) net.bars.push_back({number(i - 1), number(i)});
        if (i >= kSide && i - kSide != kHole) net.bars.push_back({number(i - kSide), number(i)});
    }
    net.mass_kg.assign(net.points_m.size(), 1.0);
    net.velocity_m_s.assign(net.points_m.size(), {});
    net.pinned = {0};
    const BodyPlan plan = test::plan_of(build_system({}, {&net, 1}), WorldDef{}, 5e-5, kFrames, 60);
    EXPECT_TRUE(std::holds_alternative<ExactDef>(plan.trials.front().method));
    EXPECT_TRUE(plan.trials.front().diverged);
    EXPECT_TRUE(std::holds_alternative<RattleDef>(plan.method));
    EXPECT_EQ(plan.reason, PlanReason::kGraph);
    EXPECT_FALSE(plan.horizon_s.has_value());
    EXPECT_LE(plan.error_estimate_m.value(), 5e-5);
}

TEST(AutoPlan, TakesTheSameStepAtEveryFrameRate) {
    RopeDef ring = test::ring(9);
    ring.bending_n_m2 = 1e-2;
    const System system = build_system({&ring, 1});
    const BodyPlan quick = test::plan_of(system, WorldDef{}, 1e-3, FrameRate(Rational{60, 1}), 30);
    const BodyPlan slow = test::plan_of(system, WorldDef{}, 1e-3, FrameRate(Rational{7, 1}), 3);
    EXPECT_EQ(quick.method, slow.method);
}

TEST(AutoPlan, GivesBarsThatDependOnEachOtherRelaxationWithoutAnEstimate) {
    // In line: a bar from end to end makes it a rod, which the equations of the first order do not know.
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, -1.0}, {2.0, -2.0}, {3.0, -3.0}};
    net.bars = {{0, 1}, {1, 2}, {2, 3}, {0, 3, false}};
    net.pinned = {0};
    const BodyPlan plan = test::plan_of(build_system({}, {&net, 1}), WorldDef{}, 1e-3, kFrames, 60);
    EXPECT_TRUE(std::holds_alternative<RelaxationDef>(plan.method));
    EXPECT_FALSE(plan.error_estimate_m.has_value());
    EXPECT_EQ(plan.reason, PlanReason::kDependent);
}

TEST(AutoPlan, RefusesBodiesThatNoMethodCanRun) {
    RopeDef taut = reference::straight_rope(4, 1.0, 90.0);
    taut.pinned = {0, 4};
    EXPECT_EQ(refusal_of(build_system({&taut, 1})), Reason::kTautBetweenPins);
    // `relaxation` would run bars without length, in a chain as in a ring.
    RopeDef rope = reference::straight_rope(4, 1.0, 45.0);
    rope.points_m[2] = rope.points_m[1];
    EXPECT_EQ(refusal_of(build_system({&rope, 1})), Reason::kBarWithoutLength);
    RopeDef ring = test::ring(5);
    ring.points_m[2] = ring.points_m[1];
    EXPECT_EQ(refusal_of(build_system({&ring, 1})), Reason::kBarWithoutLength);
}

/// A swinging rope and a ring.
struct Mixed {
    std::vector<RopeDef> ropes{reference::straight_rope(5, 1.0, 30.0), test::free_ring(5)};
    System system = build_system(ropes);
    Timeline timeline{kFrames, 30};
    PlanDef def{[](const MotionBounds&) { return 1e-3; }, timeline, {}, {}};
    Recording recording{system.particle_count(), timeline.size()};
};

TEST(AutoPlans, ChooseAMethodPerBodyAndRecordWhatTheyMove) {
    Mixed mixed;
    const Plan plan = plan_methods(mixed.system, NamedMethods(2), WorldDef{}, mixed.def, mixed.recording);
    ASSERT_EQ(plan.bodies.size(), 2U);
    EXPECT_EQ(plan.bodies[0].reason, PlanReason::kExact);
    EXPECT_EQ(plan.bodies[1].reason, PlanReason::kExact);
    EXPECT_EQ(plan.error_estimate_m,
              std::max(plan.bodies[0].error_estimate_m.value(), plan.bodies[1].error_estimate_m.value()));
    EXPECT_FALSE(plan.horizon_s.has_value());
    EXPECT_GE(plan.simulation_passes, 2);
    const std::vector<MethodDef> methods{plan.bodies[0].method, plan.bodies[1].method};
    Simulation run(mixed.system, WorldDef{}, methods);
    ASSERT_EQ(mixed.recording.size(), 31U);
    State state;
    for (std::size_t k = 0; k <= 30; ++k) {
        ASSERT_EQ(run.advance_to(mixed.timeline.time_s(k)), Status::kOk);
        mixed.recording.read(k, state);
        EXPECT_EQ(state.x_m, run.state().x_m);
        EXPECT_EQ(state.y_m, run.state().y_m);
        EXPECT_EQ(state.time_s, run.state().time_s);
        // The same sum in another order.
        EXPECT_NEAR(mixed.recording.figures(k).energy_error.value(), run.figures().energy_error.value(),
                    1e-15);
        EXPECT_EQ(mixed.recording.figures(k).strain, run.figures().strain);
        EXPECT_EQ(mixed.recording.figures(k).loads.value().pin_force_n,
                  run.figures().loads.value().pin_force_n);
    }
    EXPECT_EQ(mixed.recording.diagnostics().steps, run.diagnostics().steps);
    EXPECT_NEAR(mixed.recording.diagnostics().largest.energy_error.value(),
                run.diagnostics().largest.energy_error.value(), 1e-15);
}

/// A chaotic rope on a small share of the budget.
TEST(AutoPlan, DrawsARunWithoutChecksWhereItsBudgetEnds) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    const System system = build_system({&rope, 1});
    const Timeline timeline(kFrames, 300);
    PlanDef def{[](const MotionBounds&) { return 1e-4; }, timeline, {}, {}};
    std::array<BodyPlan, 2> plans;
    for (BodyPlan& plan : plans) {
        def.share = 1e-4;
        Recording recording(system.particle_count(), timeline.size());
        plan = plan_body(system, WorldDef{}, def, recording);
        EXPECT_EQ(recording.size(), timeline.size());
        EXPECT_TRUE(plan.unchecked);
        ASSERT_TRUE(plan.horizon_s.has_value());
        EXPECT_LT(*plan.horizon_s, 3.0);
        EXPECT_LE(plan.error_estimate_m.value(), 1e-4);
    }
    EXPECT_EQ(plans[0].horizon_s, plans[1].horizon_s);
    EXPECT_EQ(plans[0].error_estimate_m, plans[1].error_estimate_m);
}

bool is_implicit(const MethodDef& method) {
    return std::get<ExactDef>(method).implicit;
}

TEST(AutoPlan, TakesImplicitStepsForLongRopesThatHang) {
    for (const double angle_deg : {0.0, 30.0}) {
        const BodyPlan plan = plan_of(reference::straight_rope(1000, 1.0, angle_deg), 1.2e-4, 30);
        EXPECT_TRUE(is_implicit(plan.method));
        EXPECT_LE(plan.error_estimate_m, 1.2e-4);
        EXPECT_FALSE(plan.horizon_s);
        EXPECT_EQ(plan.passes, 2);
        EXPECT_LE(plan.trials.back().check_steps, 2 * plan.trials.back().steps);
    }
    EXPECT_FALSE(is_implicit(plan_of(reference::straight_rope(100, 1.0, 30.0), 1.2e-4, 30).method));
    EXPECT_FALSE(is_implicit(plan_of(reference::straight_rope(400, 1.0, 91.0), 1.2e-4, 3).method));
    EXPECT_FALSE(is_implicit(plan_of(reference::straight_rope(400, 1.0, 30.0), 1e-9, 3).method));
}

// Its vibrations are visible, and implicit steps would be as short as explicit ones.
TEST(AutoPlan, TakesExplicitStepsForALongRopeThatIsRough) {
    RopeDef rope = reference::straight_rope(400, 1.0, 30.0);
    for (std::size_t i = 1; i < rope.points_m.size(); i += 2) rope.points_m[i].x += 1e-3;
    const BodyPlan plan = plan_of(rope, 2e-4, 10);
    EXPECT_TRUE(is_implicit(plan.trials.front().method));
    EXPECT_FALSE(is_implicit(plan.method));
    EXPECT_LE(plan.error_estimate_m, 2e-4);
    EXPECT_FALSE(plan.horizon_s);
}

TEST(AutoPlans, RunNamedMethodsUnchangedWithoutAnEstimate) {
    Mixed mixed;
    const NamedMethods named{RelaxationDef{}, std::nullopt};
    const Plan plan = plan_methods(mixed.system, named, WorldDef{}, mixed.def, mixed.recording);
    EXPECT_EQ(plan.bodies[0].reason, PlanReason::kNamed);
    EXPECT_TRUE(std::get<RelaxationDef>(plan.bodies[0].method).step_s.has_value());  // filled in
    EXPECT_TRUE(plan.bodies[1].error_estimate_m.has_value());
    EXPECT_FALSE(plan.error_estimate_m.has_value());
    EXPECT_EQ(mixed.recording.size(), 31U);
}

TEST(AutoPlans, NameTheBodyThatNoMethodCanRun) {
    Mixed mixed;
    mixed.ropes[0].pinned = {0, 5};
    mixed.system = build_system(mixed.ropes);
    try {
        static_cast<void>(
            plan_methods(mixed.system, NamedMethods(2), WorldDef{}, mixed.def, mixed.recording));
        FAIL();
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Reason::kTautBetweenPins);
        EXPECT_EQ(std::string(refusal.what()).find("rope 0: "), 0U) << refusal.what();
    }
}

TEST(AutoPlans, ReportTheProgressOfAllBodies) {
    Mixed mixed;
    std::int64_t last = -1;
    std::size_t falls = 0;
    mixed.def.on_progress = [&](std::int64_t done, std::int64_t total) {
        EXPECT_EQ(total, 2 * 31);
        if (done < last) ++falls;
        last = done;
        return true;
    };
    const Plan plan = plan_methods(mixed.system, NamedMethods(2), WorldDef{}, mixed.def, mixed.recording);
    EXPECT_EQ(last, 61);
    std::size_t trials = 0;
    for (const BodyPlan& body : plan.bodies) trials += body.trials.size();
    EXPECT_LE(falls, trials);  // each begins at 0
}

TEST(AutoPlans, RecogniseANetThatIsHeldStill) {
    const auto why_still = [](const NetDef& net) {
        const System system = build_system({}, {&net, 1});
        const Timeline timeline(kFrames, 10);
        Recording recording(system.particle_count(), timeline.size());
        const PlanDef def{[](const MotionBounds&) { return 1e-3; }, timeline, {}, {}};
        const Plan plan = plan_methods(system, NamedMethods(1), WorldDef{}, def, recording);
        EXPECT_TRUE(plan.error_estimate_m.has_value());
        return plan.bodies.front().stands_still;
    };
    NetDef plate = test::cloth(5, 4, 0.1);
    EXPECT_EQ(why_still(plate), StandsStill::kPlate);
    NetDef curtain = plate;
    std::erase_if(curtain.bars, [](const NetBar& bar) { return !bar.is_real; });
    EXPECT_EQ(why_still(curtain), StandsStill::kRow);
    curtain.velocity_m_s.back() = {1.0, 0.0};
    EXPECT_EQ(why_still(curtain), StandsStill::kNo);
    plate.pinned = curtain.pinned = {0};
    EXPECT_EQ(why_still(plate), StandsStill::kNo);
    EXPECT_EQ(why_still(test::leaning_net(4, 3, 0.1)), StandsStill::kNo);
}

}  // namespace
}  // namespace corda::sim
