#include "corda/render/vector.hpp"

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

TEST(Strokes, JoinConsecutiveCapsulesOfOneWidth) {
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

TEST(Strokes, MakeARingOneLine) {
    view::DrawList list = list_of_one_layer();
    list.add_ring({50.0, 50.0}, 20.0, 1.0);
    const LayerStrokes strokes = strokes_of(list, list.layers.front());
    ASSERT_EQ(strokes.lines.size(), 1U);
    ASSERT_EQ(strokes.lines[0].lines.size(), 1U);
    EXPECT_EQ(strokes.lines[0].lines[0].size(), 65U);
}

TEST(Strokes, OfATintedLayerHaveBluntEndsOnTop) {
    view::DrawList list = list_of_one_layer();
    list.layers.front().is_tinted = true;
    list.add_capsule({10.0, 10.0}, {20.0, 10.0}, 2.0, 1.0, {1, 0, 0});
    list.add_capsule({20.0, 10.0}, {30.0, 10.0}, 2.0, 1.0, {1, 0, 0});
    list.add_capsule({30.0, 10.0}, {40.0, 10.0}, 2.0, 1.0, {0, 1, 0});
    list.add_capsule({40.0, 10.0}, {40.0, 10.0}, 5.0, 1.0, {0, 1, 0});
    const LayerStrokes strokes = strokes_of(list, list.layers.front());
    ASSERT_EQ(strokes.lines.size(), 5U);
    EXPECT_EQ(strokes.lines[0].color, (Color{1, 0, 0}));
    EXPECT_EQ(strokes.lines[0].lines.front().size(), 3U);
    EXPECT_FALSE(strokes.lines[1].is_blunt);
    EXPECT_TRUE(strokes.lines[2].is_blunt);
    EXPECT_TRUE(strokes.lines[3].is_blunt);
    EXPECT_EQ(strokes.lines[4].width_px, 10.0);  // the dot
    EXPECT_FALSE(strokes.lines[4].is_blunt);
    EXPECT_EQ(strokes.halos.size(), 2U);  // of two widths, in one colour
}

TEST(EvenLayers, HaveTheAlphaOfFadedCapsules) {
    view::DrawList list = list_of_one_layer();
    list.layers.front().color.a = 200;
    list.add_capsule({10.0, 10.0}, {20.0, 10.0}, 2.0, 0.0, {}, 0.25);
    list.add_capsule({20.0, 10.0}, {30.0, 10.0}, 2.0);
    list.add_layer({1, 2, 3});
    list.add_capsule({10.0, 50.0}, {20.0, 50.0}, 2.0);
    const view::DrawList even = in_even_layers(list);
    double strong = 0.0;
    double faint = 0.0;
    for (std::size_t l = 0; l + 1 < even.layers.size(); ++l) {
        const double alpha = even.layers[l].color.a / 255.0;
        strong += (1.0 - strong) * alpha;
        if (even.layers[l].capsule_count == 2) faint += (1.0 - faint) * alpha;
    }
    EXPECT_NEAR(strong, 200.0 / 255.0, 0.01);
    EXPECT_NEAR(faint, 0.25 * 200.0 / 255.0, 1.0 / 12.0);
    EXPECT_EQ(even.layers.back().color, (Color{1, 2, 3}));
    EXPECT_EQ(even.capsules[even.layers.back().first_capsule].ay, 50.0F);
}

TEST(Boxes, ExtendBelowTheirOpaqueNeighbour) {
    view::DrawList list = list_of_one_layer();
    list.add_box({10, 10, 12, 20}, {1, 2, 3});
    list.add_box({12, 10, 14, 20}, {4, 5, 6});
    list.add_box({14, 10, 16, 20}, {7, 8, 9, 100});
    list.add_box({16, 10, 18, 21}, {4, 5, 6});
    const std::vector<view::Stamp> boxes = boxes_of(list);
    ASSERT_EQ(boxes.size(), 4U);
    EXPECT_EQ(boxes[0].box.x1, 13);
    EXPECT_EQ(boxes[1].box.x1, 14);  // the next one is transparent
    EXPECT_EQ(boxes[2].box.x1, 16);  // and the next one higher
}

}  // namespace
}  // namespace corda::render
