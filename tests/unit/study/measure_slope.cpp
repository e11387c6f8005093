#include "corda/study/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace corda::study {
namespace {

TEST(Slope, IsTheExponentOfAPowerLaw) {
    std::vector<std::pair<double, double>> points;
    for (const double h : {0.1, 0.05, 0.02, 0.01}) points.emplace_back(h, 3.0 * std::pow(h, 4.0));
    const auto slope = fit_slope(points);
    ASSERT_TRUE(slope.has_value());
    EXPECT_NEAR(slope->exponent, 4.0, 1e-12);
    EXPECT_EQ(slope->points, 4U);
    // By hand: x = 0, 1, 2 and y = 0, 2, 1 in powers of e.
    const double e = std::numbers::e;
    const std::vector<std::pair<double, double>> scattered{{1.0, 1.0}, {e, e * e}, {e * e, e}};
    EXPECT_NEAR(fit_slope(scattered)->exponent, 0.5, 1e-14);
}

TEST(Slope, NeedsThreePoints) {
    std::vector<std::pair<double, double>> points{{0.1, 1e-3}, {0.05, 1e-4}};
    EXPECT_FALSE(fit_slope(points).has_value());
    points.emplace_back(0.02, 0.0);  // has no logarithm
    points.emplace_back(0.01, std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(fit_slope(points).has_value());
    const std::vector<std::pair<double, double>> one_step(5, {0.1, 1e-3});
    EXPECT_FALSE(fit_slope(one_step).has_value());
}

}  // namespace
}  // namespace corda::study
