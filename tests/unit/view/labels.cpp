#include "corda/view/labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/view/overlay.hpp"

namespace corda::view {
namespace {

/// The labels of ropes at their start.
std::vector<BodyLabel> labels_of(const std::vector<RopeDef>& ropes, const std::vector<std::string>& names,
                                 const std::vector<BodyStyleDef>& styles = {}) {
    System system = build_system(ropes);
    for (std::size_t i = 0; i < names.size(); ++i) system.bodies[i].label = names[i];
    return body_labels(make_scene_view(system, {0.0, -9.81}, {}, styles, 200, 100));
}

TEST(Labels, AreAboveTheirPinOrAtTheirFreeEnd) {
    RopeDef rope = reference::straight_rope(3, 1.0, 30.0);
    RopeDef apart = rope;
    apart.origin_m = {1.0, 0.0};
    EXPECT_TRUE(labels_of({rope}, {""}).empty());
    const auto at_pins = labels_of({rope, apart}, {"a", "b"});
    ASSERT_EQ(at_pins.size(), 2U);
    EXPECT_EQ(at_pins[1].text, "b");
    EXPECT_EQ(at_pins[1].particle, 4U);
    EXPECT_EQ(at_pins[1].from, 4U);
    // A pin that another labelled body shares has no room; that of one without a label has.
    const auto at_ends = labels_of({rope, rope, rope}, {"a", "b", ""});
    EXPECT_EQ(at_ends[1].particle, 7U);
    EXPECT_EQ(at_ends[1].from, 6U);
    EXPECT_EQ(labels_of({rope, rope}, {"a", ""})[0].particle, 0U);
    // Where styles say; in rows above one pin.
    std::vector<BodyStyleDef> styles(2);
    styles[0].label_at = LabelAt::kEnd;
    EXPECT_EQ(labels_of({rope}, {"8 kg"}, styles)[0].particle, 3U);
    const auto apart_at_one_pin = labels_of({rope, rope}, {"a", "b"}, styles);
    EXPECT_EQ(apart_at_one_pin[1].particle, 4U);
    EXPECT_EQ(apart_at_one_pin[1].row, 0);
    styles[0].label_at = styles[1].label_at = LabelAt::kPin;
    const auto in_rows = labels_of({rope, rope}, {"a", "b"}, styles);
    EXPECT_EQ(in_rows[0].particle, 0U);
    EXPECT_EQ(in_rows[0].row, 0);
    EXPECT_EQ(in_rows[1].particle, 4U);
    EXPECT_EQ(in_rows[1].row, 1);
    rope.pinned = {};
    EXPECT_EQ(labels_of({rope}, {"free"})[0].particle, 3U);
}

TEST(Labels, AreShortenedAndDoNotOverprint) {
    std::vector<BodyLabel> labels(2);
    labels[0].text.assign(200, 'x');
    labels[1].text = "8 kg";
    labels[1].row = 1;
    MotionBounds pin;
    pin.include(0.0, 0.0);
    const Overlay overlay = make_overlay({}, {}, 1000, 500, 0.02, {.labels = labels});
    const std::vector<Drawn> all = drawn_labels(overlay.area, overlay.labels, std::vector{pin});
    EXPECT_LE(all[0].left_px + all[0].right_px, 300.0);
    EXPECT_GT(all[1].up_px, all[0].up_px);
    DrawList list;
    list.width = 1000;
    list.height = 500;
    Caption caption;
    caption.labels.assign(2, {{500.0, 250.0}, {500.0, 250.0}});
    draw(overlay, caption, 100.0, list);
    EXPECT_TRUE(list.texts.at(0).utf8.ends_with("…"));
    EXPECT_EQ(list.texts.at(1).utf8, "8 kg");
    EXPECT_TRUE(Font().ink(list.texts[0]).intersected(Font().ink(list.texts[1])).empty());
}

TEST(TimesOfPoses, AreNearestToTheirOwnBalls) {
    std::vector<PoseTime> poses;
    for (int i = 0; i < 12; ++i) {
        const PixelPoint at{100.0 + 15.0 * i * i / 4.0, 200.0};
        poses.push_back({{std::to_string(i), 0, 1, 12.0}, {at, {at.x, 100.0}, 12.0}});
    }
    DrawList list;
    list.width = 800;
    list.height = 400;
    draw_times(make_overlay({}, {}, 800, 400, 0.02).area, poses, list);
    EXPECT_GE(list.texts.size(), 4U);
    EXPECT_LT(list.texts.size(), 12U);
    for (const Text& text : list.texts) {
        const PixelRect ink = Font().ink(text);
        const auto distance = [&](const PoseTime& pose) {
            return std::hypot(std::clamp<double>(pose.place.at.x, ink.x0, ink.x1) - pose.place.at.x,
                              std::clamp<double>(pose.place.at.y, ink.y0, ink.y1) - pose.place.at.y);
        };
        for (const PoseTime& pose : poses) {
            EXPECT_GT(distance(pose), 12.0) << text.utf8;
            EXPECT_LE(distance(poses[std::stoul(text.utf8)]), distance(pose)) << text.utf8;
        }
    }
}

}  // namespace
}  // namespace corda::view
