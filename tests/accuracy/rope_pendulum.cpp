// The method `rope` on a single pendulum: PHYSICS R1 and R2. The reference file data/a01_pendulum.txt holds x
// y at t = 0.5, 1, ..., 2000 s of the IFToMM benchmark problem A01 (simple pendulum), worked out to more
// digits than double holds.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include "support/rattle_run.hpp"

namespace corda::sim {
namespace {

TEST(BenchmarkA01R1, TwoThousandSecondsStayWithinTenMicrometres) {
    std::ifstream file(std::string(CORDA_TEST_DATA) + "/a01_pendulum.txt");
    ASSERT_TRUE(file) << CORDA_TEST_DATA;
    RopeDef rope = test::straight_rope(1, 1.0, 90.0);
    rope.points_m[1] = {1.0, 0.0};
    test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 50.0);
    double largest_m = 0.0;
    double largest_tension_n = 0.0;
    int points = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    while (file >> x_m >> y_m) {
        ASSERT_TRUE(run.go(0.5 * ++points));
        largest_m = std::max(largest_m, run.tip_distance(x_m, y_m));
        largest_tension_n = std::max(largest_tension_n, run.solver().loads()->largest_tension_n);
    }
    std::printf("A01: error %.2e m, energy %.2e, tension %.8f\n", largest_m, run.energy_error(),
                largest_tension_n);
    EXPECT_EQ(points, 4000);
    EXPECT_LT(largest_m, 1e-5);
    EXPECT_LT(run.energy_error(), 1e-11);
    EXPECT_NEAR(largest_tension_n, 3.0 * 9.81, 1e-4);  // between the output times it is missed by little
}

TEST(BenchmarkA01R1, TensionAtTheBottomIsThreeTimesTheWeight) {
    RopeDef rope = test::straight_rope(1, 1.0, 90.0);
    rope.points_m[1] = {1.0, 0.0};
    test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 200.0);
    ASSERT_TRUE(run.go(2.3678419475762374 / 4.0));
    EXPECT_NEAR(run.solver().loads()->largest_tension_n, 29.43, 1e-11);
    EXPECT_NEAR(run.solver().loads()->pin_force_n, 29.43, 1e-11);
    EXPECT_NEAR(run.tip_x(), 0.0, 1e-12);
}

TEST(LargeAnglesR2, AQuarterPeriodEndsUnderThePin) {
    struct Row {
        double angle_deg;
        double period_over_t0;
        double bound_m;
    };
    constexpr double kSmallPeriodSeconds = 2.006066680710647;
    const std::array<Row, 9> rows{{{10, 1.0019071881432166, 1e-12},
                                   {45, 1.0399733431968039, 1e-12},
                                   {90, 1.1803405990160962, 1e-12},
                                   {120, 1.3728805006183502, 1e-12},
                                   {150, 1.762203729503756, 1e-12},
                                   {170, 2.4393627196738841, 1e-12},
                                   {179, 3.9010651603890857, 1e-11},
                                   {179.9, 5.3668671090259463, 1e-10},
                                   {179.99, 6.832737338014762, 1e-9}}};
    for (const Row& row : rows) {
        test::RattleRun run(test::straight_rope(1, 1.0, row.angle_deg), WorldDef{}, 8, 1.0 / 500.0);
        ASSERT_TRUE(run.go(0.25 * row.period_over_t0 * kSmallPeriodSeconds));
        std::printf("%g deg: x = %.1e\n", row.angle_deg, run.tip_x());
        EXPECT_NEAR(run.tip_x(), 0.0, row.bound_m) << row.angle_deg;
        EXPECT_LT(run.tip_y(), 0.0);
    }
}

TEST(LargeAnglesR2, CirculatingReturnsAfterItsPeriod) {
    RopeDef rope = test::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * 9.81), 0.0};
    test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 500.0);
    ASSERT_TRUE(run.go(1.0578477230355216));
    EXPECT_LT(run.tip_distance(0.0, -1.0), 1e-12);
}

}  // namespace
}  // namespace corda::sim
