#include "corda/figures/thinning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace corda::figures {
namespace {

TEST(Thinner, KeepsShortCurvesAsTheyAre) {
    Thinner thinner(Thinner::kMaxPoints);
    for (int k = 0; k < Thinner::kMaxPoints; ++k) thinner.add({1.0 * k, std::cos(k), std::sin(k)});
    const auto points = thinner.points();
    ASSERT_EQ(points.size(), 2000U);
    EXPECT_EQ(points[1234].x, std::cos(1234));
    EXPECT_TRUE(thinner.is_joined());
}

/// A spiral that turns once in 700 rows, with a spike of one row in each direction.
std::vector<CurvePoint> thin_spiral(Thinner thinner, int rows) {
    for (int k = 0; k < rows; ++k) {
        const double angle = k / 111.0;
        CurvePoint point{0.01 * k, k * std::cos(angle), k * std::sin(angle)};
        if (k == 33'333) point.y = 1e6;
        if (k == 66'667) point.x = -1e6;
        thinner.add(point);
    }
    return thinner.points();
}

TEST(Thinner, LosesNoExtreme) {
    constexpr int kRows = 100'001;
    for (const Thinner::Kind kind : {Thinner::Kind::kOverTime, Thinner::Kind::kPath}) {
        const Thinner thinner(kRows, kind);
        EXPECT_EQ(thinner.is_joined(), kind == Thinner::Kind::kOverTime);
        const auto points = thin_spiral(thinner, kRows);
        EXPECT_LE(points.size(), 2000U);
        EXPECT_GT(points.size(), 1200U);  // measured 1238 (both ends are extremes) and 1966
        const auto has = [&](double x, double y) {
            return std::any_of(points.begin(), points.end(),
                               [&](const CurvePoint& p) { return p.x == x || p.y == y; });
        };
        EXPECT_TRUE(has(HUGE_VAL, 1e6));
        EXPECT_TRUE(has(-1e6, HUGE_VAL));
        EXPECT_EQ(points.front().time_s, 0.0);
        EXPECT_EQ(points.back().time_s, 1000.0);
        EXPECT_TRUE(std::is_sorted(points.begin(), points.end(),
                                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; }));
    }
}

TEST(Thinner, SpreadsTheDotsOfAPathEvenly) {
    const auto points = thin_spiral(Thinner(100'001, Thinner::Kind::kPath), 100'001);
    double longest_s = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i)
        longest_s = std::max(longest_s, points[i].time_s - points[i - 1].time_s);
    EXPECT_NEAR(longest_s, 0.51, 1e-9);  // 51 rows
    EXPECT_TRUE(Thinner(7'000, Thinner::Kind::kPath).is_joined());
}

TEST(Thinner, BreaksACurveAtUnknownValues) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    Thinner thinner(60'000);  // blocks of 181
    for (int k = 0; k < 60'000; ++k) thinner.add({1.0 * k, 1.0 * k, k < 30'000 ? kNone : 1.0});
    const auto points = thinner.points();
    EXPECT_TRUE(std::isnan(points.front().y));
    EXPECT_EQ(points.back().y, 1.0);
    const auto known = std::find_if(points.begin(), points.end(), [](const auto& p) { return p.y == 1.0; });
    EXPECT_EQ(known->x, 30'000.0);
}

TEST(Thinner, KeepsTheEndOfAMotionThatEndsEarly) {
    Thinner thinner(60'000);
    for (int k = 0; k < 100; ++k) thinner.add({1.0 * k, 1.0 * k, -1.0 * k});
    EXPECT_EQ(thinner.points().back().x, 99.0);
    EXPECT_EQ(thinner.points().size(), 2U);
}

}  // namespace
}  // namespace corda::figures
