// Method `exact` against R1, R8 and R11 (section 4 of src/corda/sim/README.md) beyond what
// published_numbers.cpp compares, and at the first moment of a motion.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "support/reference_files.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// Accelerations of all particles at the start, from the rates at which the links' directions change.
std::vector<Vec2> start_accelerations(ChainDynamics& dynamics) {
    const std::vector<double>& y = dynamics.initial_state();
    std::vector<double> slope(y.size());
    dynamics.derivative(y.data(), slope.data());
    const std::size_t links = dynamics.chains().link_count();
    std::vector<Vec2> result = {{}};
    for (std::size_t i = 0; i < links; ++i) {
        const double rate = y[2 * links + i];
        const double turning = slope[2 * links + i];
        const Vec2 direction{y[i], y[links + i]};
        const Vec2 across{-direction.y, direction.x};
        const double length_m = 1.0 / static_cast<double>(links);
        result.push_back(result.back() + length_m * (turning * across - rate * rate * direction));
    }
    return result;
}

TEST(HorizontalRelease, FallsFreelyAtFirst) {
    for (const int links : {2, 10, 50}) {
        const RopeDef rope = reference::straight_rope(links, 1.0, 90.0);
        const System system = build_system({&rope, 1});
        ChainDynamics dynamics(system, system.bodies, WorldDef{});
        std::vector<double> tension_n;
        dynamics.tensions(dynamics.initial_state().data(), tension_n);
        for (const double tension : tension_n) EXPECT_LT(std::abs(tension), 1e-13);
        const std::vector<Vec2> accelerations = start_accelerations(dynamics);
        // The links but the first turn at no rate: every free particle has the first one's acceleration.
        for (std::size_t i = 1; i < accelerations.size(); ++i) {
            EXPECT_NEAR(accelerations[i].x, 0.0, 1e-13);
            EXPECT_NEAR(accelerations[i].y, -9.81, 1e-13);  // measured 1.8e-15; tensions and x exactly 0
        }
    }
}

TEST(FreeRope, FallsWithoutAnErrorOfTheStart) {
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.pinned = {};
    test::ExactRun run(rope);
    for (const double time_s : {1.0 / 60.0, 0.1, 1.0, 3.0}) {
        ASSERT_TRUE(run.go(time_s));
        for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
            EXPECT_NEAR(run.state().x_m[i], rope.points_m[i].x, 1e-15);
            EXPECT_NEAR(run.state().y_m[i], rope.points_m[i].y - 0.5 * 9.81 * time_s * time_s, 3e-14);
        }
    }
}

TEST(SpinningR8, HasTheTensionsOfARigidRotation) {
    constexpr int kLinks = 10;
    constexpr double kRate = 3.0;
    const RopeDef rope = reference::spinning_rope(kLinks, 1.0, kRate);
    const System system = build_system({&rope, 1});
    ChainDynamics dynamics(system, system.bodies, WorldDef{{0.0, 0.0}, 10.0, 0.0});
    std::vector<double> tension_n;
    dynamics.tensions(dynamics.initial_state().data(), tension_n);
    for (int i = 1; i <= kLinks; ++i) {
        double outside = 0.0;
        for (int j = i; j <= kLinks; ++j) outside += j;
        EXPECT_NEAR(tension_n[static_cast<std::size_t>(i - 1)], kRate * kRate * outside / kLinks, 1e-12);
    }
}

TEST(ReportRopeR11, StaysOnTheReference) {
    test::ExactRun run(reference::report_rope(40), 1e-9, WorldDef{{0.0, -9.8}, 10.0, 0.0});
    for (const test::ReportFrame& frame : test::read_report_swing()) {
        ASSERT_TRUE(run.go(frame.time_s));
        double largest_m = 0.0;
        for (std::size_t i = 0; i < frame.points_m.size(); ++i) {
            largest_m = std::max(largest_m, length(run.state().x_m[i] - frame.points_m[i].x,
                                                   run.state().y_m[i] - frame.points_m[i].y));
        }
        std::printf("R11 t=%g: %.1e m\n", frame.time_s, largest_m);
        EXPECT_LT(largest_m, 1e-10);  // measured 6.0e-14 (of 39 m)
    }
}

TEST(ReportRopeR11, IsCloserThanTheToleranceAtEveryOrderOfTheSeries) {
    constexpr reference::PublishedTip kEnd = reference::kReportTips.back();
    static_assert(kEnd.time_s == 10.0);
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-13}) {
        test::ExactRun run(reference::report_rope(40), tolerance, WorldDef{{0.0, -9.8}, 10.0, 0.0});
        ASSERT_TRUE(run.go(10.0));
        const double error = run.tip_error_m(kEnd.tip_m) / 39.2;
        std::printf("R11 at %g: %.1e of the length\n", tolerance, error);
        EXPECT_LT(error, 1e-2 * tolerance);  // measured 1.4e-8, 1.3e-10, 4.0e-12, 2.2e-16
    }
}

TEST(PendulumR1, LargestTensionIsThreeWeights) {
    test::ExactRun run(reference::straight_rope(1, 1.0, 90.0), 1e-12);
    ASSERT_TRUE(run.go(reference::kA01PeriodSeconds / 4.0));
    const Loads loads = run.loads().value();
    EXPECT_NEAR(loads.largest_tension_n, 29.43, 1e-11);
    EXPECT_NEAR(loads.pin_force_n, 29.43, 1e-11);
}

}  // namespace
}  // namespace corda::sim
