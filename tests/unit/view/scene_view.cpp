#include "corda/view/scene_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "support/draw_list_of.hpp"
#include "support/draw_lists.hpp"

namespace corda::view {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 100;

/// The draw list of ropes and nets at their start, with a fitted camera.
DrawList draw(std::vector<RopeDef> ropes, const StyleDef& style, std::vector<BodyStyleDef> styles = {},
              const std::vector<NetDef>& nets = {}, Vec2 gravity_m_s2 = {0.0, -9.81}) {
    for (RopeDef& rope : ropes) rope.reach = rope.material.is_string ? 1 : 3;
    const System system = build_system(ropes, nets);
    styles.resize(ropes.size() + nets.size());
    const State state{0.0, system.x_m, system.y_m};
    std::vector<MotionBounds> motion;
    test::include(state, motion);
    const SceneView view = make_scene_view(system, gravity_m_s2, style, styles, kWidth, kHeight, {motion});
    const CameraDef fitted = fit_camera({}, system.origin_m, drawn(view, motion), kWidth, kHeight);
    DrawList list;
    draw(view, state, Camera(fitted, system.origin_m, kWidth, kHeight), list);
    std::erase_if(list.layers, [](const Layer& layer) { return layer.capsule_count == 0; });
    return list;
}

/// Links alone, 4 pixels wide.
const StyleDef& plain() {
    static const StyleDef kPlain = [] {
        StyleDef style;
        style.rope_width_px = 4.0;
        style.payload = style.supports = style.halo = false;
        return style;
    }();
    return kPlain;
}

TEST(SceneView, APlainRopeIsOneLayerOfItsLinks) {
    const DrawList list = draw({reference::straight_rope(5, 1.0, 30.0)}, plain());
    ASSERT_EQ(list.layers.size(), 1U);
    EXPECT_EQ(list.layers[0].capsule_count, 5U);
    EXPECT_EQ(list.capsules[0].radius, 2.0F);
    EXPECT_EQ(list.capsules[0].halo_radius, 0.0F);
}

/// The links and markers of one rope at a time, and at a later one.
std::array<std::vector<std::size_t>, 2> counts_at(const RopeDef& rope, const StyleDef& style, double before_s,
                                                  double after_s) {
    std::array<std::vector<std::size_t>, 2> counts;
    const System system = build_system({&rope, 1});
    State state{before_s, system.x_m, system.y_m};
    std::vector<MotionBounds> motion;
    test::include(state, motion);
    const SceneView view = make_scene_view(system, {0.0, -9.81}, style, {}, kWidth, kHeight, {motion});
    const Camera camera(fit_camera({}, {}, drawn(view, motion), kWidth, kHeight), {}, kWidth, kHeight);
    for (auto* const of : {&counts[0], &counts[1]}) {
        DrawList list;
        draw(view, state, camera, list);
        for (const Layer& layer : list.layers) of->push_back(layer.capsule_count);
        state.time_s = after_s;
    }
    return counts;
}

TEST(SceneView, ALinkThatIsCutIsGone) {
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.cuts = {{1, 1.0}, {3, 2.0}};
    const auto [before, after] = counts_at(rope, plain(), 0.99, 1.0);
    EXPECT_EQ(before[0], 5U);
    EXPECT_EQ(after[0], 4U);
    StyleDef bars = plain();
    bars.bars = Bars::kAll;
    rope.reach = 2;
    const auto [all, left] = counts_at(rope, bars, 0.0, 2.0);
    // Imaginary bars, links and real bars: those over both cuts are gone.
    EXPECT_EQ(all[0], 4U);
    EXPECT_EQ(left[0], 0U);
    EXPECT_EQ(all[2], 5U);
    EXPECT_EQ(left[2], 3U);
}

TEST(SceneView, AParticleWithoutLinksIsADot) {
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.cuts = {{1, 1.0}, {2, 2.0}};
    const auto [one, both] = counts_at(rope, plain(), 1.5, 2.0);
    EXPECT_EQ(one[0], 4U);
    EXPECT_EQ(both[0], 3U + 1U);
    rope.cuts = {{4, 0.0}};  // the free end
    EXPECT_EQ(counts_at(rope, plain(), 0.0, 1.0)[0][0], 4U + 1U);
}

TEST(SceneView, APinThatIsLetGoIsAFreeParticle) {
    RopeDef rope = reference::straight_rope(2, 1.0, 30.0);
    rope.releases = {{0, 1.0}};
    StyleDef style = plain();
    style.markers = Markers::kAll;
    const auto [before, after] = counts_at(rope, style, 0.0, 1.0);
    EXPECT_EQ(before[1], 2U);  // free ones
    EXPECT_EQ(after[1], 3U);
    EXPECT_EQ(before.back(), 1U);
    EXPECT_EQ(after.back(), 0U);
    // A pendulum has a ball there from then on.
    style = plain();
    style.payload = true;
    const auto [balls, more] = counts_at(reference::straight_rope(2, 1.0, 30.0), style, 0.0, 1.0);
    EXPECT_EQ(balls, more);
    const auto [hung, thrown] = counts_at(rope, style, 0.0, 1.0);
    EXPECT_EQ(hung[0], balls[0]);
    EXPECT_EQ(thrown[0], hung[0] + 1);
}

TEST(SceneView, APinThatIsLetGoMayBeTheFreeEnd) {
    RopeDef rope = reference::straight_rope(4, 1.0, 30.0);
    rope.pinned = {0, 4};
    System system = build_system({&rope, 1});
    EXPECT_EQ(free_end(system, system.bodies[0]), std::nullopt);
    rope.releases = {{4, 1.0}};
    system = build_system({&rope, 1});
    EXPECT_EQ(free_end(system, system.bodies[0]), 4U);
}

TEST(SceneView, APinThatMovedLeavesNoTrail) {
    RopeDef rope = reference::straight_rope(4, 1.0, 30.0);
    rope.moves = {{0, {{{0.1, 0.0}, 1.0, 0.0}}, {}}};
    rope.releases = {{0, 1.0}};
    const System system = build_system({&rope, 1});
    StyleDef style = plain();
    style.trail_s = 0.5;
    const SceneView view = make_scene_view(system, {0.0, -9.81}, style, {}, kWidth, kHeight);
    ASSERT_EQ(view.traced, (std::vector<std::size_t>{4, 0}));
    const Trail trail{{0.4, {0.0, 0.0}, {1.0, 0.0}}, {0.0, {0.4, 0.0}, {1.0, 0.0}}};
    const std::vector<Trail> trails{trail, trail};
    const auto layers = [&](double time_s) {
        DrawList list;
        start(view, list);
        draw_trails(view, trails, time_s, Camera({Vec2{0.0, 0.0}, 2.0}, {}, kWidth, kHeight), list);
        return list.layers.size();
    };
    EXPECT_EQ(layers(0.9), 2U);
    EXPECT_EQ(layers(1.0), 1U);
}

TEST(SceneView, MergedBodiesAreOneTintedLayerInAGradient) {
    std::vector<BodyStyleDef> styles(4);
    for (const std::size_t i : {1, 2, 3}) styles[i].merged = i > 1;
    StyleDef style = plain();
    style.halo = true;
    const std::vector<RopeDef> ropes(4, reference::straight_rope(5, 1.0, 30.0));
    const DrawList list = draw(ropes, style, styles);
    ASSERT_EQ(list.layers.size(), 2U);
    EXPECT_FALSE(list.layers[0].is_tinted);
    EXPECT_TRUE(list.layers[1].is_tinted);
    EXPECT_EQ(list.layers[1].capsule_count, 15U);
    const auto tint = [&](std::size_t i) { return list.capsules.at(5 + 5 * i).tint; };
    EXPECT_EQ(tint(0), (Tint{0x90, 0x74, 0xe9}));  // the ends of the dark theme's scale
    EXPECT_EQ(tint(2), (Tint{0xff, 0xf4, 0x66}));
    EXPECT_NE(tint(1), tint(0));
    EXPECT_GT(list.capsules[5].halo_radius, 0.0F);
    styles[2].color = Color{1, 2, 3, 255};
    EXPECT_EQ(draw(ropes, style, styles).capsules.at(10).tint, (Tint{1, 2, 3}));
    // A palette is gone through; the rope before takes its first colour in turn.
    styles[2].color.reset();
    style.palette = {{10, 0, 0}, {20, 0, 0}, {20, 0, 90}};
    const DrawList own = draw(ropes, style, styles);
    EXPECT_EQ(own.layers[0].color, style.palette[0]);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(own.capsules.at(5 + 5 * i).tint,
                  (Tint{style.palette[i].r, style.palette[i].g, style.palette[i].b}))
            << i;
}

TEST(SceneView, EveryBodyIsOneLayerOfItsColour) {
    StyleDef style = plain();
    style.palette = {Color{1, 2, 3, 255}, Color{4, 5, 6, 255}};
    const std::vector<RopeDef> ropes(4, reference::straight_rope(2, 1.0, 30.0));
    // A rope of its own colour uses none of the palette up.
    std::vector<BodyStyleDef> styles(4);
    styles[0].color = Color{9, 9, 9, 255};
    const DrawList list = draw(ropes, style, styles);
    ASSERT_EQ(list.layers.size(), 4U);
    EXPECT_EQ(list.layers[0].color, (Color{9, 9, 9, 255}));
    EXPECT_EQ(list.layers[1].color, (Color{1, 2, 3, 255}));
    EXPECT_EQ(list.layers[2].color, (Color{4, 5, 6, 255}));
    EXPECT_EQ(list.layers[3].color, (Color{1, 2, 3, 255}));
}

TEST(SceneView, AnyNumberOfColoursIsDrawn) {
    const std::vector<RopeDef> ropes(100, reference::straight_rope(1, 1.0, 0.0));
    std::vector<BodyStyleDef> styles(ropes.size());
    for (std::size_t i = 0; i < styles.size(); ++i)
        styles[i].color = Color{static_cast<std::uint8_t>(i), 0, 0, 255};
    EXPECT_EQ(draw(ropes, plain(), styles).layers.size(), ropes.size());
}

TEST(SceneView, LinesAreAShareOfTheShorterSideAndNeverThinnerThanTwoPixels) {
    StyleDef style = plain();
    style.rope_width_px = std::nullopt;
    const System system = build_system({{reference::straight_rope(1, 1.0, 0.0)}}, {});
    const auto width_px = [&](int width, int height) {
        const SceneView view = make_scene_view(system, {}, style, {}, width, height);
        return 2.0 * drawn(view, std::vector<MotionBounds>(2))[0].up_px;
    };
    EXPECT_DOUBLE_EQ(width_px(1920, 1080), 9.0);
    EXPECT_DOUBLE_EQ(width_px(1080, 1920), 9.0);
    EXPECT_DOUBLE_EQ(width_px(168, 94), 2.0);
}

TEST(SceneView, AllButTheFirstBodyHaveHalos) {
    StyleDef style = plain();
    style.halo = true;
    const DrawList list = draw(std::vector<RopeDef>(2, reference::straight_rope(1, 1.0, 30.0)), style);
    EXPECT_EQ(list.capsules[0].halo_radius, 0.0F);
    EXPECT_FLOAT_EQ(list.capsules[1].halo_radius, 2.0F + 0.35F * 4.0F);
}

TEST(SceneView, APayloadIsABallThatGrowsWithItsMass) {
    StyleDef style = plain();
    style.payload = true;
    RopeDef rope = reference::straight_rope(9, 1.0, 30.0);  // 10 kg
    EXPECT_EQ(draw({rope}, style).layers.size(), 1U);
    for (const auto& [mass_kg, radius] :
         {std::pair{1.0, 1.8F}, {10.0, 1.8F * 1.0F}, {80.0, 1.8F * 2.0F}, {1e9, 5.5F}}) {
        rope.payload_kg = mass_kg;
        const DrawList list = draw({rope}, style);
        ASSERT_EQ(list.layers.size(), 2U);  // rope and ball, outline
        const Capsule& ball = list.capsules[list.layers[0].capsule_count - 1];
        // To the middle of the outline, which is a quarter of a pixel wide.
        EXPECT_FLOAT_EQ(ball.radius, std::max(radius, 3.2F) - 0.125F) << mass_kg;
        EXPECT_EQ(ball.length, 0.0F);
        EXPECT_EQ(list.layers[1].color, theme_colors(style).outline);
    }
    style.payload = false;
    EXPECT_EQ(draw({rope}, style).layers.size(), 1U);
}

TEST(SceneView, ABallHasTheRadiusThatIsGivenInThePicture) {
    StyleDef style = plain();
    style.payload = true;
    RopeDef rope = reference::straight_rope(9, 1.0, 90.0);
    rope.payload_kg = 2.0;
    for (const double radius_m : {0.1, 0.02, 1e-6}) {
        style.payload_radius_m = radius_m;
        const DrawList list = draw({rope}, style);
        const Capsule& link = list.capsules[0];
        const Capsule& ball = list.capsules[list.layers[0].capsule_count - 1];
        // Nine links of 1 m in all; never less than a little more than the rope.
        EXPECT_NEAR(ball.radius + 0.125, std::max(radius_m * 9.0 * link.length, 3.2), 1e-3) << radius_m;
        EXPECT_LE(ball.ax + ball.radius, kWidth);
    }
}

TEST(SceneView, RopesOfUpToThreeLinksHaveABobOnEveryFreeMass) {
    StyleDef style = plain();
    style.payload = true;
    const DrawList three = draw({reference::straight_rope(3, 1.0, 30.0)}, style);
    ASSERT_EQ(three.layers.size(), 2U);
    EXPECT_EQ(three.layers[0].capsule_count, 3U + 3U);
    EXPECT_EQ(draw({reference::straight_rope(4, 1.0, 30.0)}, style).layers.size(), 1U);
}

RopeDef slack_string(std::vector<Vec2> points_m, std::vector<double> rest_m) {
    RopeDef rope;
    rope.points_m = std::move(points_m);
    rope.rest_m = std::move(rest_m);
    rope.material.is_string = true;
    return rope;
}

TEST(SceneView, ASlackLinkHangsAsAnArcOfItsLength) {
    const DrawList list = draw({slack_string({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, {1.0, 1.5})}, plain());
    ASSERT_GT(list.capsules.size(), 5U);
    const double metre_px = static_cast<double>(list.capsules[0].length);  // the taut one is straight
    double arc_px = 0.0;
    double lowest_px = 0.0;
    for (std::size_t i = 1; i < list.capsules.size(); ++i) {
        arc_px += static_cast<double>(list.capsules[i].length);
        lowest_px = std::max(lowest_px, static_cast<double>(list.capsules[i].ay - list.capsules[0].ay));
    }
    EXPECT_NEAR(arc_px / metre_px, 1.5, 1e-3);
    EXPECT_GT(lowest_px, 0.3 * metre_px);
    // Without gravity it bends to its left, which is up.
    const DrawList weightless =
        draw({slack_string({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, {1.0, 1.5})}, plain(), {}, {}, {});
    EXPECT_LT(weightless.capsules[3].ay, weightless.capsules[0].ay);
}

TEST(SceneView, BarsAndMarkersHaveLayersOfTheirOwn) {
    StyleDef style = plain();
    style.markers = Markers::kAll;
    style.bars = Bars::kAll;
    const DrawList list = draw({reference::straight_rope(5, 1.0, 30.0)}, style);
    ASSERT_EQ(list.layers.size(), 5U);
    EXPECT_EQ(list.layers[0].color, theme_colors(style).imaginary_bar);
    EXPECT_EQ(list.layers[0].capsule_count, 4U + 3U);  // reach 2 and 3 among 6 particles
    EXPECT_EQ(list.layers[2].color, theme_colors(style).real_bar);
    EXPECT_EQ(list.layers[2].capsule_count, 5U);
    EXPECT_EQ(list.layers[3].capsule_count, 5U);  // free particles
    EXPECT_EQ(list.layers[4].capsule_count, 1U);  // the pinned one on top
    EXPECT_EQ(list.layers[4].color, theme_colors(style).pinned);
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
    const DrawList list = draw({}, plain(), {}, {square_net()});
    ASSERT_EQ(list.layers.size(), 1U);
    ASSERT_EQ(list.layers[0].capsule_count, 4U);
    // Two sides across, two down: all of them, and of one length.
    for (const Capsule& capsule : list.capsules) {
        EXPECT_EQ(capsule.radius, 1.0F);
        EXPECT_NEAR(capsule.length, list.capsules[0].length, 2e-3);  // ends are rounded to 1/1024
    }
    std::vector<BodyStyleDef> own(1);
    own[0].width_px = 7.0;
    EXPECT_EQ(draw({}, plain(), own, {square_net()}).capsules[0].radius, 3.5F);
}

TEST(SceneView, NetsTakeThePaletteAfterTheRopes) {
    const StyleDef style = plain();
    const DrawList list = draw({reference::straight_rope(3, 1.0, 30.0)}, style, {}, {square_net()});
    ASSERT_EQ(list.layers.size(), 2U);
    EXPECT_EQ(list.layers[0].color, theme_colors(style).palette[0]);
    EXPECT_EQ(list.layers[0].capsule_count, 3U);
    EXPECT_EQ(list.layers[1].color, theme_colors(style).palette[1]);
    EXPECT_EQ(list.layers[1].capsule_count, 4U);
}

TEST(SceneView, ANetHasItsBarsAndMarkersInTheCommonLayers) {
    StyleDef style = plain();
    style.markers = Markers::kAll;
    style.bars = Bars::kAll;
    const DrawList list = draw({}, style, {}, {square_net()});
    ASSERT_EQ(list.layers.size(), 5U);
    EXPECT_EQ(list.layers[0].color, theme_colors(style).imaginary_bar);
    EXPECT_EQ(list.layers[0].capsule_count, 1U);
    EXPECT_EQ(list.layers[2].color, theme_colors(style).real_bar);
    EXPECT_EQ(list.layers[2].capsule_count, 4U);
    EXPECT_EQ(list.layers[3].capsule_count, 2U);
    EXPECT_EQ(list.layers[4].capsule_count, 2U);
}

TEST(SceneView, AClosedRopeHasItsLastLink) {
    std::vector<RopeDef> ropes(1, reference::straight_rope(2, 1.0, 30.0));
    ropes[0].points_m[2].x += 1.0;
    EXPECT_EQ(draw(ropes, plain()).capsules.size(), 2U);
    ropes[0].closed = true;
    EXPECT_EQ(draw(ropes, plain()).capsules.size(), 3U);
}

TEST(SceneView, ASlackLinkStaysInsideThePictureAndATautOneNeedsNoRoom) {
    const std::vector<Vec2> points_m{{0.0, 0.0}, {0.5, 0.1}};
    for (const Vec2 gravity_m_s2 : {Vec2{0.0, -1.0}, {0.0, 1.0}, {1.0, 0.0}, {-1.0, 0.5}, {}}) {
        const DrawList list = draw({slack_string(points_m, {2.0})}, plain(), {}, {}, gravity_m_s2);
        EXPECT_GE(test::bounds_of(list).x0, 4);
        EXPECT_GE(test::bounds_of(list).y0, 4);
        EXPECT_LE(test::bounds_of(list).x1, kWidth - 4);
        EXPECT_LE(test::bounds_of(list).y1, kHeight - 4);
    }
    const System system =
        build_system({{slack_string({{0.0, 0.0}, {0.0, -1.0}, {0.0, -2.0}}, {1.0, 1.0})}}, {});
    const SceneView view = make_scene_view(system, {0.0, -1.0}, plain(), {}, kWidth, kHeight);
    std::vector<MotionBounds> motion;
    test::include({0.0, system.x_m, system.y_m}, motion);
    EXPECT_EQ(drawn(view, motion)[0].bounds.min_m(), (Vec2{0.0, -2.0}));
    EXPECT_EQ(drawn(view, motion)[0].bounds.max_m(), (Vec2{0.0, 0.0}));
}

TEST(SceneView, AllThatIsDrawnStaysInsideThePicture) {
    StyleDef style;
    style.markers = Markers::kPinned;
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.payload_kg = 1000.0;
    for (const Vec2 gravity_m_s2 : {Vec2{0.0, -1.0}, {0.0, 1.0}, {1.0, 0.0}, {-1.0, 0.0}, {}}) {
        const DrawList list = draw({rope}, style, {}, {}, gravity_m_s2);
        EXPECT_GE(test::bounds_of(list).x0,
                  5);  // a margin of 8 pixels, less what a capsule's bounds have to spare
        EXPECT_GE(test::bounds_of(list).y0, 5);
        EXPECT_LE(test::bounds_of(list).x1, kWidth - 5);
        EXPECT_LE(test::bounds_of(list).y1, kHeight - 5);
    }
}

TEST(SceneView, LinksTakeTheColoursOfAListInTurnAndABallThatOfItsLink) {
    StyleDef style = plain();
    style.color_by = ColorBy::kLink;
    style.payload = true;
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.payload_kg = 1.0;
    BodyStyleDef two;
    two.link_colors = {{1, 2, 3, 100}, {4, 5, 6, 100}};
    NetDef net;
    net.points_m = {{2.0, 0.0}, {2.5, 0.0}, {2.0, -0.5}};
    net.bars = {{0, 1}, {1, 2}, {0, 2}};
    net.pinned = {0};
    const DrawList list = draw({rope, rope}, style, {two, {}, two}, {net});
    ASSERT_EQ(list.layers.size(), 5U);  // and the outlines of two balls
    EXPECT_TRUE(list.layers[0].is_tinted);
    EXPECT_EQ(list.layers[0].color.a, 100);
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(list.capsules[k].tint.r, k % 2 == 0 ? 1 : 4) << k;
    EXPECT_EQ(list.capsules[5].tint, (Tint{1, 2, 3, 64}));  // the ball on the fifth link
    EXPECT_FALSE(list.layers[2].is_tinted);
    EXPECT_EQ(list.layers[2].color, theme_colors(style).palette[0]);
    EXPECT_TRUE(list.layers[4].is_tinted);
    EXPECT_EQ(list.capsules[list.layers[4].first_capsule + 1].tint.r, 4);
}

TEST(SceneView, LinksTakeTheColoursOfAScale) {
    StyleDef style = plain();
    style.color_by = ColorBy::kSpeed;
    const RopeDef rope = reference::straight_rope(2, 1.0, 0.0);
    const System system = build_system({&rope, 1});
    State state{0.0, system.x_m, system.y_m};
    state.vx_m_s = {0.0, 3.0, 0.0};
    state.vy_m_s = {0.0, 4.0, 10.0};
    const Camera camera({.center_m = Vec2{}, .height_m = 4.0}, system.origin_m, kWidth, kHeight);
    const auto draw_with = [&](const std::optional<ColorScale>& scale) {
        DrawList list;
        draw(make_scene_view(system, {0.0, -9.81}, style, {}, kWidth, kHeight, {{}, scale}), state, camera,
             list);
        return list;
    };
    EXPECT_FALSE(draw_with({}).layers.front().is_tinted);
    sim::Histogram histogram;
    histogram.add(10.0);
    const ColorScale scale = scale_of(Quantity::kSpeed, histogram, style);
    const DrawList list = draw_with(scale);
    ASSERT_TRUE(list.layers.front().is_tinted);
    const auto color = [&](std::size_t k) {
        const Tint tint = list.capsules[k].tint;
        return Color{tint.r, tint.g, tint.b};
    };
    EXPECT_EQ(color(0), scale.color(2.5));
    EXPECT_EQ(color(1), scale.color(7.5));
}

TEST(SceneView, ARopeTapersFromItsFirstLinkToItsLast) {
    StyleDef style = plain();
    style.payload = true;
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.payload_kg = 1e-9;
    BodyStyleDef own;
    own.width_px = 12.0;
    own.end_width_px = 4.0;
    const DrawList list = draw({rope, rope}, style, {own, own});
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(list.capsules[i].radius, 6.0F - static_cast<float>(i)) << i;
    StyleDef halos = style;
    halos.halo = true;
    const DrawList apart = draw({rope, rope}, halos, {own, own});
    const Capsule& last = apart.capsules[apart.layers[2].first_capsule + 4];
    EXPECT_FLOAT_EQ(last.halo_radius, 2.0F + 0.35F * 4.0F);
}

TEST(SceneView, TracesTheFreeEndsOrGivenParticlesOfEachBody) {
    StyleDef style;
    style.trail_s = 1.0;
    const System system = build_system(
        std::vector{reference::straight_rope(2, 1.0, 30.0), reference::straight_rope(5, 1.0, 30.0)});
    const auto traced = [&] { return traced_particles(system, style); };
    EXPECT_EQ(traced(), (std::vector<std::size_t>{2, 8}));
    style.trail_of = {1, -1, 4, -6};
    EXPECT_EQ(traced(), (std::vector<std::size_t>{1, 2, 4, 8, 7, 3}));
    style.trail_of = {-1, 2, 2, 5};
    EXPECT_EQ(traced(), (std::vector<std::size_t>{2, 8, 5}));
    style.trail_s = 0.0;
    EXPECT_TRUE(traced().empty());
}

}  // namespace
}  // namespace corda::view
