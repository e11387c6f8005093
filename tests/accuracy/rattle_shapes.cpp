// Method `rattle` on known motions: R6 (hanging between pins), R7 (falling folded chain) and R8 (spinning
// chain) of src/sim/README.md, free fall, and the first moment of a horizontal release.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

TEST(HangingBetweenPinsR6, ComesToTheReferenceShape) {
    for (const reference::HangingChain& row : reference::kHangingChains) {
        WorldDef world;
        world.drag_1_s = 8.0;
        test::RattleRun run(reference::slack_rope(row.links), world, 4);
        ASSERT_TRUE(run.go(15.0));
        const double lowest_m = *std::min_element(run.state().y_m.begin(), run.state().y_m.end());
        const double force_n = run.loads()->pin_force_n;
        const double half_weight_n = 0.5 * (row.links - 1) * 9.81;
        const double horizontal = std::sqrt(force_n * force_n - half_weight_n * half_weight_n) / 9.81;
        std::printf("N=%d: tension off by %.1e, lowest point by %.1e\n", row.links,
                    horizontal - row.tension_over_weight, lowest_m - row.lowest_m);
        EXPECT_NEAR(horizontal, row.tension_over_weight, 1e-10) << row.links;
        EXPECT_NEAR(lowest_m, row.lowest_m, 1e-10) << row.links;
        EXPECT_DOUBLE_EQ(run.loads()->largest_tension_n, force_n);
    }
}

/// The time at which the tip of the folded chain has fallen `depth_m`, by secants.
double fall_time_s(const RopeDef& rope, double depth_m, double from_s) {
    double early_s = from_s;
    double late_s = from_s + 0.2;
    double time_s = from_s;
    for (int i = 0; i < 60; ++i) {
        time_s = 0.5 * (early_s + late_s);
        test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 2000.0);
        EXPECT_TRUE(run.go(time_s));
        (run.tip_y() > -depth_m ? early_s : late_s) = time_s;
        if (late_s - early_s < 2e-8) break;
    }
    return time_s;
}

TEST(FallingFoldedChainR7, TheTipFallsInTheReferenceTimes) {
    for (const reference::FoldedChain& row : reference::kFoldedChains) {
        const RopeDef rope = reference::folded_rope(row.links);
        for (std::size_t k = 0; k < 3; ++k) {
            const double time_s =
                fall_time_s(rope, 0.25 * (1.0 + static_cast<double>(k)), row.times_s[k] - 0.1);
            std::printf("N=%d, %g m: off by %.1e s\n", row.links, 0.25 * (1.0 + static_cast<double>(k)),
                        time_s - row.times_s[k]);
            EXPECT_NEAR(time_s, row.times_s[k], 1e-6) << row.links;
        }
    }
}

TEST(SpinningChainR8, StaysARigidRotation) {
    constexpr int kLinks = 10;
    constexpr double kOmega = 7.0;
    WorldDef world;
    world.gravity_m_s2 = {};
    test::RattleRun run(reference::spinning_rope(kLinks, 1.0, kOmega), world, 8, 1.0 / 500.0);
    // T_i = m omega^2 a sum of j from i to N; the first is largest.
    EXPECT_NEAR(run.loads()->largest_tension_n, kOmega * kOmega * 0.1 * 55.0, 1e-11);
    ASSERT_TRUE(run.go(10.0, 100));
    double error_m = 0.0;
    for (std::size_t i = 0; i <= kLinks; ++i) {
        const double x = 0.1 * static_cast<double>(i) * std::cos(kOmega * 10.0);
        const double y = 0.1 * static_cast<double>(i) * std::sin(kOmega * 10.0);
        error_m = std::max({error_m, std::abs(run.state().x_m[i] - x), std::abs(run.state().y_m[i] - y)});
    }
    std::printf("spinning: %.1e m, energy %.1e J\n", error_m, run.largest_energy_change_j());
    EXPECT_LT(error_m, 1e-10);
    EXPECT_NEAR(run.loads()->largest_tension_n, kOmega * kOmega * 0.1 * 55.0, 1e-9);
}

TEST(FreeFall, IsExactFromTheFirstStepOn) {
    for (const int order : {2, 4, 6, 8}) {
        RopeDef rope = reference::straight_rope(8, 1.0, 30.0);
        rope.pinned = {};
        test::RattleRun run(rope, WorldDef{}, order, 0.01);
        for (const double time_s : {0.01, 0.5, 1.0, 1.2345}) {
            ASSERT_TRUE(run.go(time_s));
            const double fallen_m = -0.5 * 9.81 * time_s * time_s;
            EXPECT_NEAR(run.tip_y(), run.system().y_m.back() + fallen_m, 2e-14 * (1.0 - fallen_m)) << order;
            // measured: at most 5.3e-15
            EXPECT_NEAR(run.tip_x(), run.system().x_m.back(), 1e-14) << order;
        }
        EXPECT_LT(run.loads()->largest_tension_n, 1e-12);
    }
}

TEST(HorizontalRelease, StartsAsFreeFallWithoutTension) {
    test::RattleRun run(reference::straight_rope(20, 1.0, 90.0), WorldDef{}, 4, 1.0 / 1000.0);
    ASSERT_TRUE(run.go(0.0));
    EXPECT_LT(run.loads()->largest_tension_n, 1e-13);
    // x = x0 + a t^2 / 2 + terms of t^6 and up in x, of t^4 in y.
    const double time_s = 1e-4;
    ASSERT_TRUE(run.go(time_s));
    for (std::size_t i = 1; i <= 20; ++i) {
        EXPECT_NEAR(2.0 * run.state().y_m[i] / (time_s * time_s), -9.81, 1e-5) << i;
        EXPECT_NEAR(2.0 * (run.state().x_m[i] - run.system().x_m[i]) / (time_s * time_s), 0.0, 1e-5) << i;
    }
}

}  // namespace
}  // namespace corda::sim
