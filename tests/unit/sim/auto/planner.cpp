#include "corda/sim/auto/planner.hpp"

#include <gtest/gtest.h>

#include "corda/reference/ropes.hpp"
#include "support/nets.hpp"
#include "support/plan_of.hpp"

namespace corda::sim {
namespace {

using Reason = Refusal::Reason;

const FrameRate kFrames(Rational{60, 1});

/// The plan for one rope, which has to be within `tolerance_m` up to a frame.
Plan plan_of(const RopeDef& rope, double tolerance_m, std::int64_t last_frame) {
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
    const Plan loose = plan_of(rope, 1e-3, 120);
    const Plan tight = plan_of(rope, 1e-9, 120);
    EXPECT_GT(std::get<ExactDef>(loose.method).tolerance, std::get<ExactDef>(tight.method).tolerance);
    EXPECT_LT(loose.trials.back().steps, tight.trials.back().steps);
}

TEST(AutoPlan, IsTheSameOnEveryRun) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    const Plan a = plan_of(rope, 1e-4, 300);
    const Plan b = plan_of(rope, 1e-4, 300);
    EXPECT_EQ(std::get<ExactDef>(a.method).tolerance, std::get<ExactDef>(b.method).tolerance);
    EXPECT_EQ(a.error_bound_m, b.error_bound_m);
    EXPECT_EQ(a.horizon_s, b.horizon_s);
}

TEST(AutoPlan, CountsTheRunsAndTheChecksOfAllTrials) {
    const Plan plan = plan_of(reference::straight_rope(10, 1.0, 90.0), 1e-4, 300);
    ASSERT_GT(plan.trials.size(), 1U);
    EXPECT_EQ(plan.simulation_passes, 3 * static_cast<int>(plan.trials.size()) - 1);
    EXPECT_EQ(plan.reason, PlanReason::kExact);
}

TEST(AutoPlan, GivesRigidBarsOfAGraphRattle) {
    const Plan plan = plan_of(test::ring(5), 1e-2, 10);
    EXPECT_TRUE(std::holds_alternative<RattleDef>(plan.method));
    EXPECT_EQ(plan.reason, PlanReason::kGraph);
    EXPECT_LE(plan.error_bound_m.value(), 1e-2);
}

TEST(AutoPlan, GivesANetWithDiagonalsRattle) {
    const NetDef net = test::leaning_net(6, 5, 0.2, true);
    const Plan plan = test::plan_of(build_system({}, {&net, 1}), WorldDef{}, 1e-3, kFrames, 60);
    EXPECT_TRUE(std::holds_alternative<RattleDef>(plan.method));
    EXPECT_LE(plan.error_bound_m.value(), 1e-3);
}

TEST(AutoPlan, TakesTheSameStepAtEveryFrameRate) {
    const RopeDef ring = test::ring(9);
    const System system = build_system({&ring, 1});
    const Plan quick = test::plan_of(system, WorldDef{}, 1e-3, FrameRate(Rational{60, 1}), 30);
    const Plan slow = test::plan_of(system, WorldDef{}, 1e-3, FrameRate(Rational{7, 1}), 3);
    EXPECT_EQ(std::get<RattleDef>(quick.method).order, std::get<RattleDef>(slow.method).order);
    EXPECT_EQ(std::get<RattleDef>(quick.method).step_s, std::get<RattleDef>(slow.method).step_s);
}

TEST(AutoPlan, GivesBarsThatDependOnEachOtherRelaxationWithoutABound) {
    // A straight rope whose second bars make it a rod, beside a ring.
    RopeDef ropes[] = {reference::straight_rope(4, 1.0, 40.0), test::ring(5)};
    ropes[0].reach = 2;
    const Plan plan = test::plan_of(build_system(ropes), WorldDef{}, 1e-3, kFrames, 60);
    EXPECT_TRUE(std::holds_alternative<RelaxationDef>(plan.method));
    EXPECT_FALSE(plan.error_bound_m.has_value());
    EXPECT_EQ(plan.reason, PlanReason::kDependent);
}

TEST(AutoPlan, RefusesWhatNoMethodCanTruthfullyRun) {
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

TEST(StepCost, GrowsWithTheWork) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    const RopeDef ring = test::ring(21);
    const System chain = build_system({&rope, 1});
    const System graph = build_system({&ring, 1});
    EXPECT_GT(step_cost_ns(chain, RattleDef{8}), step_cost_ns(chain, RattleDef{2}));
    EXPECT_GT(step_cost_ns(graph, RattleDef{2}), step_cost_ns(chain, RattleDef{2}));
    EXPECT_EQ(step_cost_ns(chain, RelaxationDef{.sweeps = 5}), 5.0 * step_cost_ns(chain, RelaxationDef{}));
    EXPECT_GT(step_cost_ns(chain, ExactDef{}), 0.0);
}

}  // namespace
}  // namespace corda::sim
