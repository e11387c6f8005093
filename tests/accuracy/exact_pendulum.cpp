// Method `exact` with one link against the mathematical pendulum: R1 and R2 (src/sim/README.md).

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "support/reference_files.hpp"
#include "support/root.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

double a01_error_m(double tolerance) {
    const std::vector<Vec2> reference = test::read_a01();
    test::ExactRun run(reference::straight_rope(1, 1.0, 90.0), tolerance);
    double largest = 0.0;
    for (std::size_t k = 0; k < reference.size(); ++k) {
        EXPECT_TRUE(run.go(0.5 * static_cast<double>(k + 1)));
        largest = std::max(largest, run.tip_error_m(reference[k]));
    }
    return largest;
}

TEST(PendulumR1, StaysOnTheReferenceFor2000Seconds) {
    EXPECT_LT(a01_error_m(1e-9), 1e-5);   // measured 1.0e-6
    EXPECT_LT(a01_error_m(1e-11), 1e-7);  // measured 6.5e-9
    EXPECT_LT(a01_error_m(1e-13), 1e-9);  // measured 2.0e-10
}

TEST(PendulumR1, LargestTensionIsThreeWeights) {
    test::ExactRun run(reference::straight_rope(1, 1.0, 90.0), 1e-12);
    ASSERT_TRUE(run.go(reference::kA01PeriodSeconds / 4.0));
    const Loads loads = run.loads().value();
    EXPECT_NEAR(loads.largest_tension_n, 29.43, 1e-11);
    EXPECT_NEAR(loads.pin_force_n, 29.43, 1e-11);
}

/// The time at which x of the tip changes its sign for the last time before or after `near_s`.
double crossing_s(const RopeDef& rope, double near_s) {
    const auto x_m = [&](double time_s) {
        test::ExactRun run(rope, 1e-13);
        EXPECT_TRUE(run.go(time_s));
        return run.state().x_m.back();
    };
    return test::root(x_m, near_s * (1.0 - 1e-3), near_s * (1.0 + 1e-3));
}

TEST(PeriodR2, AtLargeAnglesIsTheEllipticIntegral) {
    // Near the top an error grows by exp(sqrt(g/L) t), and so does the rounding of the start itself.
    constexpr std::array<double, reference::kSwingPeriods.size()> kBounds{1e-9, 1e-9, 1e-9, 1e-9, 1e-9,
                                                                          1e-9, 1e-7, 1e-7, 1e-7};
    for (std::size_t k = 0; k < reference::kSwingPeriods.size(); ++k) {
        const reference::SwingPeriod& row = reference::kSwingPeriods[k];
        // A quarter of a period after the start and a whole one after that.
        const double expected_s = 1.25 * row.ratio * reference::kSmallSwingSeconds;
        const double time_s = crossing_s(reference::straight_rope(1, 1.0, row.angle_deg), expected_s);
        const double error = time_s / expected_s - 1.0;
        std::printf("R2 %g deg: relative error of the period %.2e\n", row.angle_deg, error);
        // measured 1e-15 up to 170 deg, 1.3e-13 at 179, 9e-12 at 179.9, 4e-10 at 179.99
        EXPECT_LT(std::abs(error), kBounds[k]) << row.angle_deg;
    }
}

TEST(PeriodR2, OfAFullTurnIsTheEllipticIntegral) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * 9.81), 0.0};
    constexpr double kExpectedSeconds = 3.0 * reference::kFullTurnSeconds;
    const double error = crossing_s(rope, kExpectedSeconds) / kExpectedSeconds - 1.0;
    std::printf("R2 circulating: relative error of the period %.2e\n", error);
    EXPECT_LT(std::abs(error), 1e-9);  // measured 6e-16
}

}  // namespace
}  // namespace corda::sim
