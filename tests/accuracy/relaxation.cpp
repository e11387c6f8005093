// Method `relaxation` against the reference numbers in section 4 of src/corda/sim/README.md.

#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "support/simulate.hpp"

namespace corda::sim {
namespace {

TEST(FreeFallR10, WithoutDampingIsLateByHalfAStepsSpeed) {
    // The Euler start: x(t) = a t^2 / 2 - a h t / 2.
    for (const double h : {0.1, 0.01, 0.001}) {
        const int n = static_cast<int>(std::lround(2.0 / h));
        const double expected = 0.5 * -9.8 * 4.0 + 0.5 * 9.8 * h * 2.0;
        RelaxationDef solver{h};
        solver.force_n = Vec2{0.0, -9.8};
        RopeDef pair = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}});
        pair.pinned = {};
        Simulation run = test::simulate(pair, WorldDef{}, solver);
        ASSERT_EQ(run.advance_to(n * h), Status::kOk);
        EXPECT_NEAR(run.state().y_m[1], expected, 1e-12 * 20.0) << h;  // measured 1.2e-12 at h = 0.001
    }
}

/// When a horizontal rod of ten unit masses, length 1 m, gets to the vertical: the time at which its tip
/// passes under the pin, by bisection between steps.
double quarter_period_s(double step_s, int sweeps) {
    RelaxationDef solver;
    solver.step_s = step_s;
    solver.sweeps = sweeps;
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.reach = 7;
    Simulation run = test::simulate(rope, WorldDef{}, solver);
    double before_x_m = 1.0;
    for (int k = 1; k <= static_cast<int>(1.0 / step_s); ++k) {
        EXPECT_EQ(run.advance_to(k * step_s), Status::kOk);
        const double x_m = run.state().x_m.back();
        if (x_m <= 0.0) return (k - x_m / (x_m - before_x_m)) * step_s;
        before_x_m = x_m;
    }
    return 1.0;
}

TEST(RigidRodR3, ConvergedSevenNeighbourBarsAreARod) {
    constexpr reference::RodPeriod kRod = reference::kRodPeriods[2];
    static_assert(kRod.links == 10);
    constexpr double kQuarterPeriodSeconds = kRod.period_s / 4.0;
    const double coarse = std::abs(quarter_period_s(1.0 / 500.0, 1000) - kQuarterPeriodSeconds);
    const double middle = std::abs(quarter_period_s(1.0 / 1000.0, 1000) - kQuarterPeriodSeconds);
    const double fine = std::abs(quarter_period_s(1.0 / 2000.0, 1000) - kQuarterPeriodSeconds);
    EXPECT_LT(fine, 1e-3);
    EXPECT_LT(middle, coarse);
    EXPECT_LT(fine, middle);
    std::printf("quarter period errors: h=1/500 %.3e, 1/1000 %.3e, 1/2000 %.3e\n", coarse, middle, fine);
}

}  // namespace
}  // namespace corda::sim
