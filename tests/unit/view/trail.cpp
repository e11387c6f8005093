#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "corda/view/scene_view.hpp"

namespace corda::view {
namespace {

DrawList trail_of(const std::vector<FadingPoint>& path, double radius_px = 1.0, Color color = {}) {
    DrawList list;
    list.width = list.height = 400;
    add_trail(path, radius_px, color, list);
    return list;
}

/// Points of a circle about a corner of the picture, with their slopes.
std::vector<FadingPoint> circle(const std::vector<double>& left) {
    constexpr double kRadiusPx = 300.0;
    constexpr double kAngle = 1.5;
    std::vector<FadingPoint> path;
    for (const double s : left)
        path.push_back(
            {{kRadiusPx * std::cos(kAngle * s), kRadiusPx * std::sin(kAngle * s)},
             s,
             {-kAngle * kRadiusPx * std::sin(kAngle * s), kAngle * kRadiusPx * std::cos(kAngle * s)}});
    return path;
}

TEST(Trails, FadeInOneLayer) {
    std::vector<FadingPoint> path;
    for (int i = 0; i <= 60; ++i) path.push_back({{20.0 + 5.0 * i, 50.0}, i / 60.0, {300.0, 0.0}});
    const DrawList list = trail_of(path, 4.0, {10, 20, 30, 255});
    ASSERT_EQ(list.layers.size(), 1U);
    EXPECT_EQ(list.layers[0].color, (Color{10, 20, 30, 204}));
    EXPECT_LE(list.capsules.size(), 120U);  // measured 120: the shades need two per point
    for (std::size_t i = 1; i < list.capsules.size(); ++i) {
        EXPECT_GT(list.capsules[i].strength, list.capsules[i - 1].strength) << i;
        EXPECT_LT(list.capsules[i].strength, list.capsules[i - 1].strength + 255.0F / 60.0F) << i;
        EXPECT_GT(list.capsules[i].radius, list.capsules[i - 1].radius) << i;
    }
    EXPECT_LT(list.capsules.front().strength, 3.0F);
    EXPECT_GT(list.capsules.back().strength, 252.0F);
    EXPECT_NEAR(list.capsules.front().radius, 1.6F, 0.1F);
    EXPECT_NEAR(list.capsules.back().radius, 4.0F, 0.1F);
}

TEST(Trails, AreMoreTransparentThanATransparentRope) {
    const DrawList list = trail_of({{{0.0, 50.0}, 0.0, {300.0, 0.0}}, {{300.0, 50.0}, 1.0, {300.0, 0.0}}},
                                   4.0, {255, 255, 255, 128});
    EXPECT_EQ(list.layers[0].color.a, 102);
}

TEST(Trails, AreSmoothBetweenFewPoints) {
    const DrawList list = trail_of(circle({0.0, 0.5, 1.0, 1.05}));
    for (const Capsule& piece : list.capsules) {
        EXPECT_NEAR(std::hypot(piece.ax, piece.ay), 300.0,
                    0.5);  // measured 0.26; a polygon of the points: 21
        EXPECT_LT(piece.length, 20.0F);
    }
}

TEST(Trails, TakeFewPiecesWhereTheyAreShort) {
    std::vector<FadingPoint> resting;
    for (int i = 0; i <= 100; ++i) resting.push_back({{50.0, 50.0}, 0.01 * i, {}});
    EXPECT_EQ(trail_of(resting).capsules.size(), 1U);
}

TEST(Trails, StayNearTheirPointsAtAPeakOfSpeed) {
    const double fast = 1e5;  // pixels per unit, between points 10 pixels apart
    const DrawList list =
        trail_of({{{100.0, 100.0}, 0.0, {}}, {{110.0, 100.0}, 0.1, {0.0, fast}}, {{120.0, 100.0}, 0.2, {}}});
    for (const Capsule& piece : list.capsules) EXPECT_NEAR(piece.ay, 100.0F, 5.0F);  // measured 4.4
}

TEST(Trails, TakeNoMorePiecesThanTheirShare) {
    const std::vector<FadingPoint> path = circle({0.0, 0.3, 0.6, 0.9});
    for (const double most : {4.0, 10.0}) {
        DrawList list;
        list.width = list.height = 400;
        add_trail(path, 1.0, {}, list, most);
        EXPECT_EQ(list.capsules.size(), static_cast<std::size_t>(3.0 * most));
    }
}

TEST(Trails, OfOnePointAreEmpty) {
    EXPECT_TRUE(trail_of({{{50.0, 50.0}, 1.0, {}}}).capsules.empty());
    EXPECT_TRUE(trail_of({}).capsules.empty());
}

}  // namespace
}  // namespace corda::view
