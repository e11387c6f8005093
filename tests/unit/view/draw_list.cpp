#include "corda/view/draw_list.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "corda/render/coverage.hpp"
#include "support/draw_lists.hpp"

namespace corda::view {
namespace {

/// A list with one capsule.
DrawList list_of(PixelPoint a, PixelPoint b, double radius_px) {
    DrawList list;
    list.width = 100;
    list.height = 50;
    list.add_layer({});
    list.add_capsule(a, b, radius_px);
    return list;
}

TEST(DrawLists, ShowNothingIfAllIsOutsideTheFrame) {
    EXPECT_TRUE(DrawList{}.shows_nothing());
    EXPECT_FALSE(list_of({50.0, 25.0}, {50.0, 25.0}, 0.1).shows_nothing());
    EXPECT_FALSE(list_of({-50.0, 25.0}, {150.0, 25.0}, 2.0).shows_nothing());
    EXPECT_TRUE(list_of({-500.0, 25.0}, {-100.0, 25.0}, 2.0).shows_nothing());
    // Near enough to be in the list.
    EXPECT_TRUE(list_of({-3.0, 25.0}, {-3.0, 25.0}, 2.0).shows_nothing());
    EXPECT_TRUE(list_of({103.0, 25.0}, {103.0, 25.0}, 2.0).shows_nothing());
    EXPECT_TRUE(list_of({50.0, -3.0}, {50.0, -3.0}, 2.0).shows_nothing());
    EXPECT_TRUE(list_of({50.0, 53.0}, {90.0, 53.0}, 2.0).shows_nothing());
    EXPECT_FALSE(list_of({50.0, 51.0}, {90.0, 51.0}, 2.0).shows_nothing());
}

TEST(DrawLists, ContainTheirCapsulesWithTheirHalos) {
    DrawList list = list_of({50.0, 25.0}, {60.0, 25.0}, 2.0);
    EXPECT_EQ(test::bounds_of(list).x0, 47);
    list.add_layer({1, 2, 3});
    list.add_capsule({50.0, 25.0}, {60.0, 25.0}, 2.0, 5.0);
    EXPECT_EQ(test::bounds_of(list).x0, 42);
    EXPECT_EQ(list.capsules[1].halo_radius, 7.0F);
    ASSERT_EQ(list.layers.size(), 2U);
    EXPECT_EQ(list.layers[1].first_capsule, 1U);
    EXPECT_EQ(list.layers[1].capsule_count, 1U);
    list.clear();
    EXPECT_TRUE(list.layers.empty() && list.capsules.empty() && test::bounds_of(list).empty());
}

TEST(DrawLists, HaveRingsThatClose) {
    DrawList list = list_of({50.0, 25.0}, {50.0, 25.0}, 1.0);
    list.add_ring({50.0, 25.0}, 20.0, 3.0);
    ASSERT_EQ(list.capsules.size(), 1U + 64U);
    for (std::size_t i = 1; i < list.capsules.size(); ++i) {
        const Capsule& side = list.capsules[i];
        EXPECT_EQ(side.radius, 1.5F);
        EXPECT_NEAR(std::hypot(side.ax - 50.0F, side.ay - 25.0F), 20.0F, 1e-3);  // ends are rounded to 1/1024
    }
    const Capsule& last = list.capsules.back();
    EXPECT_NEAR(last.ax + last.length * last.ux, 70.0F, 1e-3);
    EXPECT_NEAR(last.ay + last.length * last.uy, 25.0F, 2e-3);
}

/// Coverage by a capsule without its halo of the pixel with centre (center_x, center_y).
std::uint32_t capsule_coverage(const Capsule& capsule, float center_x, float center_y) {
    return render::coverage_within(capsule.radius, render::segment_distance_px(capsule, center_x, center_y));
}

TEST(Capsule, EndsAreSnappedToA1024thOfAPixel) {
    const auto capsule = make_capsule({10.3, 20.7}, {10.3, 40.7}, 2.0, 100, 100);
    ASSERT_TRUE(capsule.has_value());
    EXPECT_EQ(capsule->ax * 1024.0F, std::round(10.3F * 1024.0F));
    EXPECT_EQ(capsule->ux, 0.0F);
    EXPECT_EQ(capsule->uy, 1.0F);
    EXPECT_FLOAT_EQ(capsule->length, 20.0F);
}

TEST(Capsule, OutsideTheFrameIsDropped) {
    EXPECT_FALSE(make_capsule({-50.0, 10.0}, {-50.0, 90.0}, 2.0, 100, 100).has_value());
    EXPECT_FALSE(make_capsule({10.0, 1e300}, {20.0, 1e300}, 2.0, 100, 100).has_value());
    EXPECT_TRUE(make_capsule({-1e12, 50.0}, {1e12, 50.0}, 2.0, 100, 100).has_value());
}

TEST(Capsule, FromAnywhereStaysNearTheFrame) {
    const double infinity = std::numeric_limits<double>::infinity();
    const std::array<double, 11> places{0.0,   50.0,   -1e9,  1e9,      1e17,     -1e30,
                                        1e300, -1e300, 1e308, infinity, -infinity};
    for (const double ax : places) {
        for (const double ay : places) {
            for (const double bx : places) {
                for (const double by : places) {
                    const auto capsule = make_capsule({ax, ay}, {bx, by}, 500.0, 100, 100);
                    if (!capsule) continue;
                    // Twice the radius and the margin of its edge, and a pixel for rounding.
                    EXPECT_LE(std::abs(capsule->ax - 50.0F), 50.0F + 2.0F * 502.0F + 1.0F);
                    EXPECT_LE(std::abs(capsule->ay - 50.0F), 50.0F + 2.0F * 502.0F + 1.0F);
                    EXPECT_LE(capsule->length, 3200.0F);
                    EXPECT_FALSE(capsule_bounds(*capsule, 100, 100).width() < 0);
                }
            }
        }
    }
}

TEST(Capsule, WithNaNIsDropped) {
    const double none = std::nan("");
    EXPECT_FALSE(make_capsule({none, 10.0}, {50.0, 90.0}, 2.0, 100, 100).has_value());
    EXPECT_FALSE(make_capsule({10.0, 10.0}, {50.0, none}, 2.0, 100, 100).has_value());
}

TEST(Capsule, ACutLineCoversTheSamePixels) {
    const auto whole = make_capsule({-40.0, -20.0}, {140.0, 70.0}, 3.0, 100, 100);
    const auto cut = make_capsule({-4e6, -2e6}, {4e6, 2e6}, 3.0, 100, 100);
    ASSERT_TRUE(whole.has_value());
    ASSERT_TRUE(cut.has_value());
    EXPECT_LT(cut->length, 300.0F);
    for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 100; ++x) {
            const auto near = [&](const Capsule& capsule) {
                return static_cast<int>(
                    capsule_coverage(capsule, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F));
            };
            // The directions differ in their last bits: at most one of 255 steps.
            EXPECT_LE(std::abs(near(*whole) - near(*cut)), 1) << x << ',' << y;
        }
    }
}

TEST(Capsule, BoundsHoldEveryCoveredPixel) {
    const auto capsule = make_capsule({30.2, 40.9}, {55.7, 21.3}, 4.3, 100, 100);
    ASSERT_TRUE(capsule.has_value());
    const PixelRect bounds = capsule_bounds(*capsule, 100, 100);
    for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 100; ++x) {
            const bool inside = x >= bounds.x0 && x < bounds.x1 && y >= bounds.y0 && y < bounds.y1;
            if (inside) continue;
            EXPECT_EQ(capsule_coverage(*capsule, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F),
                      0U);
        }
    }
}

double covered_area(const Capsule& capsule) {
    double area = 0.0;
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 200; ++x) {
            area +=
                capsule_coverage(capsule, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F) / 255.0;
        }
    }
    return area;
}

TEST(Coverage, AddsUpToTheAreaOfTheCapsule) {
    // 2 r l + pi r^2; the box filter is exact for lines along the axes and for thin ones too.
    for (const double radius : {0.25, 0.5, 1.0, 3.0, 20.0}) {
        const auto upright = make_capsule({100.0, 30.0}, {100.0, 170.0}, radius, 200, 200);
        const auto slanted = make_capsule({60.3, 40.1}, {150.9, 149.4}, radius, 200, 200);
        ASSERT_TRUE(upright && slanted);
        for (const auto& capsule : {*upright, *slanted}) {
            const double expected =
                2.0 * radius * static_cast<double>(capsule.length) + 3.14159265 * radius * radius;
            EXPECT_NEAR(covered_area(capsule) / expected, 1.0, 0.01) << radius;  // measured: at most 0.0058
        }
    }
}

TEST(Coverage, InsideIsFullAndOutsideIsNone) {
    const auto disc = make_capsule({50.0, 50.0}, {50.0, 50.0}, 10.0, 100, 100);
    ASSERT_TRUE(disc.has_value());
    EXPECT_EQ(capsule_coverage(*disc, 50.5F, 50.5F), 255U);
    EXPECT_EQ(capsule_coverage(*disc, 59.4F, 50.0F), 255U);
    EXPECT_EQ(capsule_coverage(*disc, 60.0F, 50.0F), 128U);
    EXPECT_EQ(capsule_coverage(*disc, 60.6F, 50.0F), 0U);
}

TEST(Coverage, RootIsAccurateToFarLessThanAStepOfGrey) {
    // A cap's coverage against std::sqrt in double, over many distances.
    const auto disc = make_capsule({50.0, 50.0}, {50.0, 50.0}, 20.0, 100, 100);
    ASSERT_TRUE(disc.has_value());
    for (int i = 0; i < 20000; ++i) {
        const float x = 50.0F + 0.0015F * static_cast<float>(i);
        const float y = 50.0F - 0.0007F * static_cast<float>(i);
        const double distance = std::hypot(static_cast<double>(x) - 50.0, static_cast<double>(y) - 50.0);
        const double exact = 255.0 * std::min(std::max(20.5 - distance, 0.0), 1.0);
        EXPECT_NEAR(capsule_coverage(*disc, x, y), exact, 0.51)
            << distance;  // measured 0.5003: rounding to 1/255
    }
}

TEST(Paint, EndsAreExactAndRoundingIsToNearest) {
    for (unsigned v = 0; v <= 255U * 255U; ++v) EXPECT_EQ(render::over_255(v), (v + 127U) / 255U) << v;
    EXPECT_EQ(render::paint_over(12, 200, 255, 255), 200U);
    EXPECT_EQ(render::paint_over(12, 200, 255, 0), 12U);
    EXPECT_EQ(render::paint_over(0, 255, 128, 255), 128U);
}

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
