#include "corda/view/scene_view.hpp"

#include <gtest/gtest.h>

#include <array>

#include "corda/core/basics.hpp"
#include "corda/reference/ropes.hpp"

namespace corda::view {
namespace {

struct Drawn {
    DrawList list;
    double clearance_px = 0.0;
};

Drawn draw(std::vector<RopeDef> ropes, const StyleDef& style, std::vector<BodyStyleDef> styles = {},
           const std::vector<NetDef>& nets = {}) {
    for (RopeDef& rope : ropes) rope.reach = 3;
    const System system = build_system(ropes, nets);
    styles.resize(ropes.size() + nets.size());
    const SceneView view(system, style, styles, 200, 100);
    const State state{0.0, system.x_m, system.y_m};
    MotionBounds bounds;
    bounds.include(state);
    const CameraDef fitted = fit_camera({}, system.origin_m, bounds, {200, 100, view.clearance_px()});
    const Camera camera(fitted, system.origin_m, 200, 100);
    Drawn drawn;
    drawn.clearance_px = view.clearance_px();
    view.draw(state, camera, drawn.list);
    return drawn;
}

const StyleDef& plain() {
    static const StyleDef kPlain = [] {
        StyleDef style;
        style.markers = Markers::kNone;
        style.rope_width_px = 4.0;
        return style;
    }();
    return kPlain;
}

TEST(SceneView, APlainRopeIsOneLayerOfItsLinks) {
    const Drawn drawn = draw({reference::straight_rope(5, 1.0, 30.0)}, plain());
    ASSERT_EQ(drawn.list.layers.size(), 1U);
    EXPECT_EQ(drawn.list.layers[0].capsule_count, 5U);
    EXPECT_EQ(drawn.list.capsules[0].radius, 2.0F);
    EXPECT_EQ(drawn.clearance_px, 2.0);
}

TEST(SceneView, RopesOfOneColourShareALayer) {
    StyleDef style = plain();
    style.palette = {Color{1, 2, 3, 255}, Color{4, 5, 6, 255}};
    const std::vector<RopeDef> ropes(4, reference::straight_rope(2, 1.0, 30.0));
    EXPECT_EQ(draw(ropes, style).list.layers.size(), 2U);
    // A rope of its own colour uses none of the palette up.
    std::vector<BodyStyleDef> styles(4);
    styles[0].color = Color{9, 9, 9, 255};
    const Drawn drawn = draw(ropes, style, styles);
    ASSERT_EQ(drawn.list.layers.size(), 3U);
    EXPECT_EQ(drawn.list.layers[1].color, (Color{1, 2, 3, 255}));
    EXPECT_EQ(drawn.list.layers[1].capsule_count, 4U);
}

TEST(SceneView, BarsAndMarkersHaveLayersOfTheirOwn) {
    StyleDef style = plain();
    style.markers = Markers::kAll;
    style.bars = Bars::kAll;
    const Drawn drawn = draw({reference::straight_rope(5, 1.0, 30.0)}, style);
    ASSERT_EQ(drawn.list.layers.size(), 5U);
    EXPECT_EQ(drawn.list.layers[0].color, style.imaginary_bar_color);
    EXPECT_EQ(drawn.list.layers[0].capsule_count, 4U + 3U);  // reach 2 and 3 among 6 particles
    EXPECT_EQ(drawn.list.layers[2].color, style.real_bar_color);
    EXPECT_EQ(drawn.list.layers[2].capsule_count, 5U);
    EXPECT_EQ(drawn.list.layers[3].capsule_count, 5U);  // free particles
    EXPECT_EQ(drawn.list.layers[4].capsule_count, 1U);  // the pinned one on top
    EXPECT_EQ(drawn.list.layers[4].color, style.pinned_color);
}

/// A unit square of four particles with one imaginary bar across it.
NetDef square_net() {
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}, {0.0, -1.0}};
    net.mass_kg.assign(4, 1.0);
    net.velocity_m_s.assign(4, {});
    net.bars = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2, false}};
    net.pinned = {0, 1};
    return net;
}

TEST(SceneView, ANetIsItsRealBarsHalfAsWideAsARope) {
    const Drawn drawn = draw({}, plain(), {}, {square_net()});
    ASSERT_EQ(drawn.list.layers.size(), 1U);
    ASSERT_EQ(drawn.list.layers[0].capsule_count, 4U);
    // Two sides across, two down: all of them, and of one length.
    for (const Capsule& capsule : drawn.list.capsules) {
        EXPECT_EQ(capsule.radius, 1.0F);
        EXPECT_NEAR(capsule.length, drawn.list.capsules[0].length, 2e-3);  // ends are rounded to 1/1024
    }
    std::vector<BodyStyleDef> own(1);
    own[0].width_px = 7.0;
    EXPECT_EQ(draw({}, plain(), own, {square_net()}).list.capsules[0].radius, 3.5F);
}

TEST(SceneView, NetsTakeThePaletteAfterTheRopes) {
    const StyleDef style = plain();
    const Drawn drawn = draw({reference::straight_rope(3, 1.0, 30.0)}, style, {}, {square_net()});
    ASSERT_EQ(drawn.list.layers.size(), 2U);
    EXPECT_EQ(drawn.list.layers[0].color, style.palette[0]);
    EXPECT_EQ(drawn.list.layers[0].capsule_count, 3U);
    EXPECT_EQ(drawn.list.layers[1].color, style.palette[1]);
    EXPECT_EQ(drawn.list.layers[1].capsule_count, 4U);
}

TEST(SceneView, ANetHasItsBarsAndMarkersInTheCommonLayers) {
    StyleDef style = plain();
    style.markers = Markers::kAll;
    style.bars = Bars::kAll;
    const Drawn drawn = draw({}, style, {}, {square_net()});
    ASSERT_EQ(drawn.list.layers.size(), 5U);
    EXPECT_EQ(drawn.list.layers[0].color, style.imaginary_bar_color);
    EXPECT_EQ(drawn.list.layers[0].capsule_count, 1U);
    EXPECT_EQ(drawn.list.layers[2].color, style.real_bar_color);
    EXPECT_EQ(drawn.list.layers[2].capsule_count, 4U);
    EXPECT_EQ(drawn.list.layers[3].capsule_count, 2U);
    EXPECT_EQ(drawn.list.layers[4].capsule_count, 2U);
}

TEST(SceneView, AClosedRopeHasItsLastLink) {
    std::vector<RopeDef> ropes(1, reference::straight_rope(2, 1.0, 30.0));
    ropes[0].points_m[2].x += 1.0;
    EXPECT_EQ(draw(ropes, plain()).list.capsules.size(), 2U);
    ropes[0].closed = true;
    EXPECT_EQ(draw(ropes, plain()).list.capsules.size(), 3U);
}

TEST(SceneView, TheRopesStayInsideThePicture) {
    const Drawn drawn = draw({reference::straight_rope(5, 1.0, 30.0)}, plain());
    EXPECT_GT(drawn.list.bounds.x0, 0);
    EXPECT_GT(drawn.list.bounds.y0, 0);
    EXPECT_LT(drawn.list.bounds.x1, 200);
    EXPECT_LT(drawn.list.bounds.y1, 100);
}

TEST(SceneView, RefusesMoreColoursThanLayers) {
    const std::vector<RopeDef> ropes(kMaxLayers + 1, reference::straight_rope(1, 1.0, 0.0));
    std::vector<BodyStyleDef> styles(ropes.size());
    for (std::size_t i = 0; i < styles.size(); ++i)
        styles[i].color = Color{static_cast<std::uint8_t>(i), 0, 0, 255};
    EXPECT_THROW(draw(ropes, plain(), styles), Error);
}

}  // namespace
}  // namespace corda::view
