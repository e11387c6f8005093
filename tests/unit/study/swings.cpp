#include "benchmark/study/swings.hpp"

#include <gtest/gtest.h>

namespace corda::study {
namespace {

TEST(Swings, OfDifferentMassesAreAlikeUnderGravity) {
    EXPECT_LT(difference_under_gravity(0.1, 10.0), 1e-12);  // measured 0
}

TEST(Swings, BarsOfReachSevenMoveTheRopeTowardsTheRod) {
    const auto truth = true_swing(20, 1.0);
    ASSERT_GT(truth.size(), 500U);
    const SwingFigures one = watch_swing({20, 1.0, 7, 1}, truth);
    const SwingFigures many = watch_swing({20, 1.0, 7, 64}, truth);
    EXPECT_EQ(one.failure, "");
    EXPECT_LT(many.strain, 0.1 * one.strain);  // measured 2.9e-4 and 9.4e-3
    EXPECT_LT(many.rod_error, one.rod_error);  // measured 0.0128 and 0.0148
}

TEST(Swings, SettleWithDampingOnly) {
    const ExactDef exact{1e-8};
    EXPECT_FALSE(settling_time_s(exact, 0.0, 60.0).has_value());
    const auto damped_s = settling_time_s(exact, 1.0, 60.0);
    ASSERT_TRUE(damped_s.has_value());
    // The amplitude falls from a tenth to a hundredth of L by exp(-t / 2).
    EXPECT_NEAR(*damped_s, 4.6, 1.5);  // measured 5.25
}

TEST(Swings, UpdateRateIsPositive) {
    EXPECT_GT(updates_per_second({20, 1.0, 7, 1}, {1, 0.001}), 1e3);
}

}  // namespace
}  // namespace corda::study
