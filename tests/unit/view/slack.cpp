#include "corda/view/slack.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace corda::view {
namespace {

constexpr PixelPoint kDown{0.0, 1.0};

double length_px(const Arc& arc) {
    double sum_px = 0.0;
    for (std::size_t i = 0; i + 1 < arc.count; ++i)
        sum_px += std::hypot(arc.points[i + 1].x - arc.points[i].x, arc.points[i + 1].y - arc.points[i].y);
    return sum_px;
}

TEST(SlackLines, HaveTheirLengthAndTheirEnds) {
    for (const PixelPoint b : {PixelPoint{100.0, 0.0}, {60.0, 80.0}, {0.0, -90.0}, {3.0, 40.0}, {0.0, 0.0}}) {
        for (const double slack : {1e-9, 0.01, 0.5, 3.0, 100.0}) {
            const double wanted_px = std::hypot(b.x, b.y) * (1.0 + slack) + 10.0 * slack;
            const Arc arc = hang_slack({7.0, 9.0}, {7.0 + b.x, 9.0 + b.y}, wanted_px, kDown);
            ASSERT_GE(arc.count, 7U);
            EXPECT_NEAR(length_px(arc), wanted_px, 1e-5);
            EXPECT_EQ(arc.points[0].x, 7.0);
            EXPECT_NEAR(arc.points[arc.count - 1].y, 9.0 + b.y, 1e-9);
        }
    }
}

TEST(SlackLines, HangSymmetricallyTowardsDown) {
    const Arc arc = hang_slack({0.0, 0.0}, {100.0, 0.0}, 150.0, kDown);
    for (std::size_t i = 1; i + 1 < arc.count; ++i) {
        EXPECT_GT(arc.points[i].y, 0.0);
        EXPECT_NEAR(arc.points[i].y, arc.points[arc.count - 1 - i].y, 1e-9);
    }
    const Arc sideways = hang_slack({0.0, 0.0}, {0.0, 100.0}, 150.0, {-1.0, 0.0});
    EXPECT_LT(sideways.points[sideways.count / 2].x, -40.0);
}

TEST(SlackLines, MoveSteadilyThroughTheVertical) {
    const Arc left = hang_slack({0.0, 0.0}, {-0.01, 50.0}, 80.0, kDown);
    const Arc right = hang_slack({0.0, 0.0}, {0.01, 50.0}, 80.0, kDown);
    for (std::size_t i = 0; i < left.count; ++i) {
        EXPECT_NEAR(left.points[i].x, right.points[i].x, 0.021);
        EXPECT_NEAR(left.points[i].y, right.points[i].y, 0.021);
    }
}

}  // namespace
}  // namespace corda::view
