#include "corda/view/draw_list.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace corda::view
