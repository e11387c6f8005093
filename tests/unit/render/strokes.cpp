#include "corda/render/strokes.hpp"

#include <gtest/gtest.h>

namespace corda::render {
namespace {

view::DrawList list_of_one_layer() {
    view::DrawList list;
    list.width = 100;
    list.height = 100;
    list.add_layer({255, 0, 0});
    return list;
}

TEST(Strokes, JoinNeighboursOfOneWidth) {
    view::DrawList list = list_of_one_layer();
    list.add_capsule({10.1, 10.2}, {20.3, 40.4}, 2.0, 1.0);
    list.add_capsule({20.3, 40.4}, {60.5, 45.6}, 2.0, 1.0);
    list.add_capsule({60.5, 45.6}, {61.7, 90.8}, 2.0, 1.0);
    list.add_capsule({70.0, 45.6}, {75.0, 50.0}, 2.0, 1.0);  // elsewhere
    list.add_capsule({75.0, 50.0}, {75.0, 60.0}, 3.0, 0.0);  // wider
    const LayerStrokes strokes = strokes_of(list, list.layers.front());
    ASSERT_EQ(strokes.lines.size(), 2U);
    EXPECT_EQ(strokes.lines[0].width_px, 4.0);
    ASSERT_EQ(strokes.lines[0].lines.size(), 2U);
    ASSERT_EQ(strokes.lines[0].lines[0].size(), 4U);
    EXPECT_NEAR(strokes.lines[0].lines[0][3].x, 61.7, 1e-3);
    EXPECT_NEAR(strokes.lines[0].lines[0][3].y, 90.8, 1e-3);
    EXPECT_EQ(strokes.lines[0].lines[1].size(), 2U);
    EXPECT_EQ(strokes.lines[1].width_px, 6.0);
    EXPECT_EQ(strokes.lines[1].lines.size(), 1U);
    ASSERT_EQ(strokes.halos.size(), 1U);  // none around the last
    EXPECT_EQ(strokes.halos[0].width_px, 6.0);
    EXPECT_EQ(strokes.halos[0].lines.size(), 2U);
}

TEST(Strokes, KeepDots) {
    view::DrawList list = list_of_one_layer();
    list.add_capsule({10.0, 10.0}, {20.0, 10.0}, 2.0);
    list.add_capsule({20.0, 10.0}, {20.0, 10.0}, 2.0);
    list.add_capsule({20.0, 10.0}, {20.0, 10.0}, 5.0);
    const LayerStrokes strokes = strokes_of(list, list.layers.front());
    ASSERT_EQ(strokes.lines.size(), 2U);
    EXPECT_EQ(strokes.lines[0].lines.size(), 2U);
    ASSERT_EQ(strokes.lines[1].lines.size(), 1U);
    EXPECT_EQ(strokes.lines[1].lines[0].size(), 2U);
}

TEST(Strokes, OfARingAreOneLine) {
    view::DrawList list = list_of_one_layer();
    list.add_ring({50.0, 50.0}, 20.0, 1.0);
    const LayerStrokes strokes = strokes_of(list, list.layers.front());
    ASSERT_EQ(strokes.lines.size(), 1U);
    ASSERT_EQ(strokes.lines[0].lines.size(), 1U);
    EXPECT_EQ(strokes.lines[0].lines[0].size(), 65U);
}

}  // namespace
}  // namespace corda::render
