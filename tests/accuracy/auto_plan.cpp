// Method auto: what it claims against numbers worked out by others (PHYSICS section 4, R5 and R11). A claim
// that proves false is a failed test.

#include <gtest/gtest.h>

#include <cmath>

#include "corda/sim/planner.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/study/references.hpp"
#include "corda/study/ropes.hpp"
#include "support/reference_files.hpp"

namespace corda::sim {
namespace {

const FrameRate kFrames(Rational{60, 1});

/// The plan for one rope, which has to be within `tolerance_m` up to a frame.
Plan plan_of(const RopeDef& rope, double tolerance_m, std::int64_t last_frame) {
    return plan_solver(build_system({&rope, 1}, 1), WorldDef{}, {tolerance_m, kFrames, last_frame});
}

class AutoBound : public testing::TestWithParam<std::tuple<std::size_t, double>> {};

TEST_P(AutoBound, IsTrueUnderTheHorizon) {
    const auto [row, tolerance] = GetParam();
    const study::ReleasedChain& chain = study::kReleasedChains[row];
    const RopeDef rope = study::released_rope(chain);
    const System system = build_system({&rope, 1}, 1);
    const double tolerance_m = tolerance * chain.length_m;
    const Plan plan = plan_of(rope, tolerance_m, kFrames.last_frame_within(chain.time_s));
    EXPECT_LE(plan.error_bound_m.value(), tolerance_m);
    if (plan.horizon_s) return;  // nothing is claimed at the row's time
    Simulation run(system, WorldDef{}, plan.solver, kFrames.interval_s());
    ASSERT_EQ(run.advance_to(chain.time_s), Status::kOk);
    const double error_m =
        std::hypot(run.state().x_m.back() - chain.tip_m.x, run.state().y_m.back() - chain.tip_m.y);
    // Measured: the error is 0.01 .. 0.4 of the bound.
    EXPECT_LE(error_m, plan.error_bound_m.value() + 1e-13 * chain.length_m);
}

INSTANTIATE_TEST_SUITE_P(R5, AutoBound,
                         testing::Combine(testing::Range<std::size_t>(0, 15),
                                          testing::Values(1e-3, 1e-4, 1e-6, 1e-9)));

/// Runs of so few steps that these follow from nothing but the first one and its growth: a check that took
/// the same steps would see rounding alone.
TEST(AutoPlan, BoundIsTrueOfAFewSteps) {
    RopeDef spring = study::straight_rope(1, 84.0, 45.0);
    spring.material.compliance_1_n = 0.005;
    RopeDef beam = study::straight_rope(3, 1.873, 0.0);
    beam.pinned = {};
    beam.bending_n_m2 = 0.88;
    beam.velocity_m_s.assign(4, {-2.9, 2.2});
    RopeDef string = study::straight_rope(4, 1.0, 60.0);
    string.rest_m.assign(4, 0.3);
    string.material.is_string = true;
    for (const RopeDef& rope : {spring, beam, string, study::straight_rope(2, 1.0, 10.0)}) {
        const System system = build_system({&rope, 1}, 1);
        for (const double tolerance_m : {1.0, 1e-2, 1e-4, 1e-6}) {
            for (const std::int64_t last_frame : {1, 6, 30}) {
                const Plan plan = plan_of(rope, tolerance_m, last_frame);
                if (plan.horizon_s) continue;
                Simulation run(system, WorldDef{}, plan.solver, kFrames.interval_s());
                Simulation truth(system, WorldDef{}, exact_solver(1e-14), kFrames.interval_s());
                double largest_m = 0.0;
                for (std::int64_t k = 1; k <= last_frame; ++k) {
                    ASSERT_EQ(run.advance_to(kFrames.time_s(k)), Status::kOk);
                    ASSERT_EQ(truth.advance_to(kFrames.time_s(k)), Status::kOk);
                    for (std::size_t i = 0; i < system.particle_count(); ++i) {
                        largest_m =
                            std::max(largest_m, std::hypot(run.state().x_m[i] - truth.state().x_m[i],
                                                           run.state().y_m[i] - truth.state().y_m[i]));
                    }
                }
                // Measured: a third of the bound, or less than its rounding.
                EXPECT_LE(largest_m, plan.error_bound_m.value() + 1e-14 * study::length_m(rope))
                    << plan.solver.tolerance << " " << last_frame;
                std::printf("few steps: %.1e of %.1e m\n", largest_m, *plan.error_bound_m);
            }
        }
    }
}

/// A beam of 1 cm whose vibrations are too quick for the tolerance, so that they limit the steps and are
/// damped by a run and its check alike, and a stretching string whose force has a kink.
TEST(AutoPlan, BoundIsTrueOfStiffBodies) {
    const FrameRate five(Rational{5, 1});
    RopeDef beam = study::straight_rope(3, 0.01, 10.0);
    beam.bending_n_m2 = 0.88;
    RopeDef string = study::straight_rope(5, 2.7, 0.0);
    string.material = {1e-4, true};
    string.velocity_m_s.assign(6, {-0.422733, 1.35414});
    string.velocity_m_s.front() = {};
    for (const auto& [rope, tolerance_m, drag_1_s] :
         {std::tuple{beam, 1e-2, 0.0}, {string, 1e-3, 0.5}, {string, 1.8e-5, 0.5}}) {
        const System system = build_system({&rope, 1}, 1);
        const WorldDef world{{0.0, -9.81}, 1.5, drag_1_s};
        const Plan plan = plan_solver(system, world, {tolerance_m, five, 7});
        ASSERT_FALSE(plan.horizon_s.has_value());
        Simulation run(system, world, plan.solver, five.interval_s());
        Simulation truth(system, world, exact_solver(1e-13), five.interval_s());
        double largest_m = 0.0;
        for (std::int64_t k = 1; k <= 7; ++k) {
            ASSERT_EQ(run.advance_to(five.time_s(k)), Status::kOk);
            ASSERT_EQ(truth.advance_to(five.time_s(k)), Status::kOk);
            for (std::size_t i = 0; i < system.particle_count(); ++i) {
                largest_m = std::max(largest_m, std::hypot(run.state().x_m[i] - truth.state().x_m[i],
                                                           run.state().y_m[i] - truth.state().y_m[i]));
            }
        }
        std::printf("stiff: %.1e of %.1e m\n", largest_m, *plan.error_bound_m);
        EXPECT_LE(largest_m, *plan.error_bound_m);
    }
}

TEST(AutoPlan, FindsNoHorizonWithinTheRegularRowsOfR5) {
    // At a thousandth of the length every row of R5 can be predicted but for one: N = 10 at 90 degrees is
    // chaotic past 2 s.
    for (const study::ReleasedChain& chain : study::kReleasedChains) {
        const RopeDef rope = study::released_rope(chain);
        const std::int64_t last_frame = kFrames.last_frame_within(chain.time_s);
        EXPECT_FALSE(plan_of(rope, 1e-3 * chain.length_m, last_frame).horizon_s.has_value())
            << chain.links << " links, " << chain.angle_deg << " degrees, " << chain.time_s << " s";
    }
}

TEST(AutoPlan, SaysWhereAChaoticMotionCanNoLongerBePredicted) {
    const RopeDef rope = study::straight_rope(10, 1.0, 90.0);
    const Plan plan = plan_of(rope, 1e-4, 600);
    ASSERT_TRUE(plan.horizon_s.has_value());
    EXPECT_GT(*plan.horizon_s, 3.0);  // measured 3.9
    EXPECT_LT(*plan.horizon_s, 5.0);  // PHYSICS: a perturbation grows by 1e15 in 5 s
}

TEST(AutoPlan, TakesALooserMethodForALooserTolerance) {
    const RopeDef rope = study::straight_rope(20, 1.0, 45.0);
    const Plan loose = plan_of(rope, 1e-3, 120);
    const Plan tight = plan_of(rope, 1e-9, 120);
    EXPECT_GT(loose.solver.tolerance, tight.solver.tolerance);
    EXPECT_LT(loose.trials.back().steps, tight.trials.back().steps);
}

TEST(AutoPlan, IsTheSameOnEveryRun) {
    const RopeDef rope = study::straight_rope(10, 1.0, 90.0);
    const Plan a = plan_of(rope, 1e-4, 300);
    const Plan b = plan_of(rope, 1e-4, 300);
    EXPECT_EQ(a.solver.tolerance, b.solver.tolerance);
    EXPECT_EQ(a.error_bound_m, b.error_bound_m);
    EXPECT_EQ(a.horizon_s, b.horizon_s);
}

TEST(AutoBound, IsTrueForTheSourceReportsStart) {
    // R11: all 40 particles at 1, 2, 5 and 10 s.
    const RopeDef rope = study::report_rope(40);
    const System system = build_system({&rope, 1}, 1);
    const WorldDef world{{0.0, -9.8}, 10.0, 0.0};
    const Plan plan = plan_solver(system, world, {1e-3, kFrames, 600});
    ASSERT_FALSE(plan.horizon_s.has_value());
    Simulation run(system, world, plan.solver, kFrames.interval_s());
    for (const test::ReportFrame& frame : test::read_report_swing()) {
        ASSERT_EQ(run.advance_to(frame.time_s), Status::kOk);
        for (std::size_t i = 0; i < frame.points_m.size(); ++i) {
            const double error_m = std::hypot(run.state().x_m[i] - frame.points_m[i].x,
                                              run.state().y_m[i] - frame.points_m[i].y);
            EXPECT_LE(error_m, plan.error_bound_m.value())
                << "particle " << i << " at " << frame.time_s << " s";
        }
    }
}

}  // namespace
}  // namespace corda::sim
