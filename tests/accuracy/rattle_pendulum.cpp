// Method `rattle` on a single pendulum: R1 and R2 (src/sim/README.md).

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "support/reference_files.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

TEST(BenchmarkA01R1, TwoThousandSecondsStayWithinTenMicrometres) {
    test::RattleRun run(reference::straight_rope(1, 1.0, 90.0), WorldDef{}, 8, 1.0 / 50.0);
    double largest_m = 0.0;
    double largest_tension_n = 0.0;
    int points = 0;
    for (const Vec2& bob_m : test::read_a01()) {
        ASSERT_TRUE(run.go(0.5 * ++points));
        largest_m = std::max(largest_m, run.tip_error_m(bob_m));
        largest_tension_n = std::max(largest_tension_n, run.loads()->largest_tension_n);
    }
    std::printf("A01: error %.2e m, energy %.2e, tension %.8f\n", largest_m, run.energy_error(),
                largest_tension_n);
    EXPECT_EQ(points, 4000);
    EXPECT_LT(largest_m, 1e-5);
    EXPECT_LT(run.energy_error(), 1e-11);
    EXPECT_NEAR(largest_tension_n, 3.0 * 9.81, 1e-4);  // between the output times it is missed by little
}

TEST(BenchmarkA01R1, TensionAtTheBottomIsThreeTimesTheWeight) {
    test::RattleRun run(reference::straight_rope(1, 1.0, 90.0), WorldDef{}, 8, 1.0 / 200.0);
    ASSERT_TRUE(run.go(reference::kA01PeriodSeconds / 4.0));
    EXPECT_NEAR(run.loads()->largest_tension_n, 29.43, 1e-11);
    EXPECT_NEAR(run.loads()->pin_force_n, 29.43, 1e-11);
    EXPECT_NEAR(run.tip_x(), 0.0, 1e-12);
}

TEST(LargeAnglesR2, AQuarterPeriodEndsUnderThePin) {
    constexpr std::array<double, reference::kSwingPeriods.size()> kBounds{1e-12, 1e-12, 1e-12, 1e-12, 1e-12,
                                                                          1e-12, 1e-11, 1e-10, 1e-9};
    for (std::size_t k = 0; k < reference::kSwingPeriods.size(); ++k) {
        const reference::SwingPeriod& row = reference::kSwingPeriods[k];
        test::RattleRun run(reference::straight_rope(1, 1.0, row.angle_deg), WorldDef{}, 8, 1.0 / 500.0);
        ASSERT_TRUE(run.go(0.25 * row.ratio * reference::kSmallSwingSeconds));
        std::printf("%g deg: x = %.1e\n", row.angle_deg, run.tip_x());
        EXPECT_NEAR(run.tip_x(), 0.0, kBounds[k]) << row.angle_deg;
        EXPECT_LT(run.tip_y(), 0.0);
    }
}

TEST(LargeAnglesR2, CirculatingReturnsAfterItsPeriod) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * 9.81), 0.0};
    test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 500.0);
    ASSERT_TRUE(run.go(reference::kFullTurnSeconds));
    EXPECT_LT(run.tip_error_m({0.0, -1.0}), 1e-12);
}

}  // namespace
}  // namespace corda::sim
