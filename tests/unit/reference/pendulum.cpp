#include "benchmark/study/reference/pendulum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "benchmark/study/reference/numbers.hpp"
#include "support/reference_files.hpp"

namespace corda::reference {
namespace {

TEST(Pendulum, IsTheA01Benchmark) {
    const Pendulum pendulum(std::sqrt(9.81L), std::numbers::pi_v<long double> / 2.0L);
    EXPECT_NEAR(pendulum.period_s(), kA01PeriodSeconds, 4e-15);  // measured 4e-16
    double largest_m = 0.0;
    int rows = 0;
    for (const Vec2& expected : test::read_a01()) {
        const Vec2 bob = pendulum.direction(0.5L * ++rows);
        largest_m = std::max(largest_m, std::hypot(bob.x - expected.x, bob.y - expected.y));
    }
    EXPECT_EQ(rows, 4000);
    EXPECT_LT(largest_m, 1e-14);  // measured 8e-16
}

TEST(Pendulum, HasThePeriodsOfR2AndR3) {
    for (const auto& [angle_deg, ratio] : kSwingPeriods) {
        if (angle_deg > 179.0) continue;  // the rounding of 179.9 itself changes the period by 4e-14
        const long double angle =
            static_cast<long double>(angle_deg) * std::numbers::pi_v<long double> / 180.0L;
        const Pendulum pendulum(std::sqrt(9.81L), angle);
        EXPECT_NEAR(pendulum.period_s() / kSmallSwingSeconds, ratio, 4e-15) << angle_deg;  // measured 4e-16
    }
    for (const auto& [masses, period_s] : kRodPeriods) {
        const Pendulum rod(rod_omega0_1_s(masses, 1.0 / masses, 9.81),
                           std::numbers::pi_v<long double> / 2.0L);
        EXPECT_NEAR(rod.period_s(), period_s, 4e-15) << masses;  // measured 2e-16
    }
}

TEST(DampedFall, IsTheSumOfItsSteps) {
    constexpr double kStep = 1.0 / 60.0;
    constexpr double kDelta = 0.1;
    constexpr double kForce = -9.8;
    double moved_m = 0.0;
    double last_move_m = 0.0;
    for (int n = 1; n <= 50; ++n) {
        // The first step of relaxation is an Euler step from rest, which does not move.
        if (n > 1) last_move_m = (1.0 - kDelta) * last_move_m + kStep * kStep * kForce;
        moved_m += last_move_m;
        EXPECT_NEAR(damped_fall_m(1.0, kStep, n, kDelta, kForce), moved_m, 1e-14) << n;
    }
}

}  // namespace
}  // namespace corda::reference
