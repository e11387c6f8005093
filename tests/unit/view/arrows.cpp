#include "corda/view/arrows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"

namespace corda::view {
namespace {

constexpr double kShorterPx = 480.0;
constexpr Vec2 kGravity{0.0, -10.0};

ArrowLayer layer_of(const System& system, Arrows kind, const ArrowExtents& extents = {}) {
    StyleDef style;
    style.arrows = kind;
    return {ArrowPlaces(system, kGravity, kind), style, kShorterPx, extents};
}

State state_of(const System& system) {
    return {0.0,
            system.x_m,
            system.y_m,
            std::vector<double>(system.particle_count(), 3.0),
            std::vector<double>(system.particle_count(), -4.0),
            std::vector<double>(system.bars.size(), 2.0)};
}

TEST(Arrows, ShowVelocitiesOfFreeParticles) {
    const System system = build_system(std::vector{reference::straight_rope(3, 1.0, 0.0)});
    const std::vector<Arrow> arrows = layer_of(system, Arrows::kVelocity).places().of(state_of(system));
    ASSERT_EQ(arrows.size(), 3U);  // the first particle is pinned
    EXPECT_EQ(arrows[0].value, (Vec2{3.0, -4.0}));
    EXPECT_TRUE(layer_of(system, Arrows::kNone).places().of(state_of(system)).empty());
}

TEST(Arrows, ShowWeights) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.mass_kg = {1.0, 0.5};
    const System system = build_system(std::vector{rope});
    const std::vector<Arrow> arrows = layer_of(system, Arrows::kWeight).places().of(state_of(system));
    ASSERT_EQ(arrows.size(), 1U);
    EXPECT_EQ(arrows[0].value, (Vec2{0.0, -5.0}));
}

TEST(Arrows, OfTensionsPullAtBothEndsOfAPendulumAndAtOneOfARope) {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}};
    rope.pinned = {0};
    rope.mass_kg = {1.0, 1.0, 1.0};
    const System system = build_system(std::vector{rope});
    State state = state_of(system);
    const auto values = [&] {
        std::vector<Vec2> all;
        for (const Arrow& arrow : layer_of(system, Arrows::kTension).places().of(state))
            all.push_back(arrow.value);
        return all;
    };
    EXPECT_EQ(values(), (std::vector<Vec2>{{0.0, 2.0}, {-2.0, 0.0}, {0.0, -2.0}}));
    state.tension_n.back() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(values().size(), 1U);
    const System chain = build_system(std::vector{reference::straight_rope(10, 1.0, 0.0)});
    EXPECT_EQ(layer_of(chain, Arrows::kTension).places().of(state_of(chain)).size(), 10U);
}

TEST(Arrows, AreFewOnManyParticlesAndOnManyBodies) {
    const System rope = build_system(std::vector{reference::straight_rope(1000, 1.0, 0.0)});
    const std::vector<Arrow> along = layer_of(rope, Arrows::kVelocity).places().of(state_of(rope));
    EXPECT_EQ(along.size(), 12U);
    EXPECT_EQ(along.front().at_m, (Vec2{rope.x_m.back(), rope.y_m.back()}));
    const System many = build_system(std::vector<RopeDef>(200, reference::straight_rope(2, 1.0, 0.0)));
    const std::size_t count = layer_of(many, Arrows::kVelocity).places().of(state_of(many)).size();
    EXPECT_LE(count, 60U);
    EXPECT_GE(count, 40U);
}

TEST(Arrows, HaveTheLongestAtAShareOfThePicture) {
    const System system = build_system(std::vector{reference::straight_rope(1, 1.0, 0.0)});
    ArrowExtents extents;
    extents.include(layer_of(system, Arrows::kVelocity).places().of(state_of(system)), false);
    EXPECT_EQ(extents.longest(), 5.0);
    const ArrowLayer layer = layer_of(system, Arrows::kVelocity, extents);
    EXPECT_DOUBLE_EQ(layer.scale().pixels_per_unit, 0.22 * kShorterPx / 5.0);
    DrawList list;
    list.width = list.height = static_cast<int>(kShorterPx);
    const CameraDef camera{Vec2{}, 4.0};
    layer.draw(state_of(system), Camera(camera, system.origin_m, list.width, list.height), list);
    ASSERT_EQ(list.layers.size(), 1U);
    EXPECT_TRUE(list.layers[0].is_note);
    EXPECT_GT(list.capsules[0].length, 0.9F * 0.22F * 480.0F);
}

/// The extents of a motion in which 5 m/s are usual, and `snaps` of 250 instants have more.
ArrowExtents extents_with(int snaps, double snap_m_s) {
    ArrowExtents extents;
    for (int i = 0; i < 250; ++i) {
        const Arrow arrow{{}, {0.0, i < snaps ? snap_m_s : 5.0}};
        extents.include({&arrow, 1}, true);
    }
    return extents;
}

TEST(Arrows, HaveTheScaleThatIsGivenUpToHalfOfTheShorterSide) {
    const System system = build_system(std::vector{reference::straight_rope(1, 1.0, 0.0)});
    const auto scale_with = [&](double pixels, const ArrowExtents& extents) {
        StyleDef style;
        style.arrows = Arrows::kVelocity;
        style.arrow_scale_px = pixels;
        return ArrowLayer({system, kGravity, Arrows::kVelocity}, style, kShorterPx, extents).scale();
    };
    for (const double largest : {5.0, 8.0}) {
        const ArrowScale scale = scale_with(24.0, extents_with(26, largest));
        EXPECT_EQ(scale.pixels_per_unit, 24.0);
        EXPECT_EQ(scale.longest, largest);
        EXPECT_FALSE(scale.is_cut);
    }
    // 240 pixels hold 5 m/s, a round number, of 40 pixels each.
    const ArrowScale cut = scale_with(40.0, extents_with(26, 8.0));
    EXPECT_EQ(cut.longest, 5.0);
    EXPECT_TRUE(cut.is_cut);
    EXPECT_EQ(scale_with(40.0, {}).pixels_per_unit, 0.0);
}

TEST(Arrows, FarLargerThanThoseOfMostInstantsAreCut) {
    EXPECT_EQ(extents_with(0, 0.0).longest(), 5.0);
    EXPECT_EQ(extents_with(5, 7.0).longest(), 7.0);
    EXPECT_FALSE(extents_with(5, 8.0).is_cut());
    EXPECT_TRUE(extents_with(1, 8.1).is_cut());
    for (const int snaps : {1, 25}) EXPECT_EQ(extents_with(snaps, 1e9).longest(), 8.0);
    EXPECT_EQ(extents_with(26, 512.0).longest(), 512.0);  // not rare
    EXPECT_FALSE(extents_with(26, 512.0).is_cut());
    ArrowExtents extents = extents_with(0, 0.0);
    const Arrow of_frame{{}, {500.0, 0.0}};
    extents.include({&of_frame, 1}, false);
    EXPECT_EQ(extents.longest(), 8.0);  // whether a frame shows the snap or an instant
    const Arrow slack;
    for (int i = 0; i < 10'000; ++i) extents.include({&slack, 1}, true);
    EXPECT_EQ(extents.longest(), 8.0);
}

TEST(Arrows, ThatAreCutHaveTwoHeadsAndTheLongestLength) {
    const System system = build_system(std::vector{reference::straight_rope(1, 1.0, 0.0)});
    const ArrowLayer layer = layer_of(system, Arrows::kVelocity, extents_with(1, 500.0));
    const auto drawn = [&](double speed_m_s) {
        State state = state_of(system);
        state.vx_m_s.back() = speed_m_s;
        state.vy_m_s.back() = 0.0;
        DrawList list;
        list.width = list.height = static_cast<int>(kShorterPx);
        layer.draw(state, Camera(CameraDef{Vec2{}, 4.0}, system.origin_m, list.width, list.height), list);
        double end_px = 0.0;
        for (const Capsule& line : list.capsules)
            end_px = std::max(end_px, static_cast<double>(surroundings(line, line.radius).x1));
        return std::pair{list.capsules.size(), end_px};
    };
    const auto [lines, end_px] = drawn(8.0);
    const auto [lines_of_cut, end_of_cut_px] = drawn(500.0);
    EXPECT_EQ(lines_of_cut, 2 * lines - 1);  // two heads and a shaft
    EXPECT_EQ(end_of_cut_px, end_px);
    EXPECT_EQ(drawn(3.0).first, lines);
}

/// The highest pixel of the arrows of a rope's tensions that hangs straight down from y = 240.
double top_px(int links, double tension_n) {
    const System system = build_system(std::vector{reference::straight_rope(links, 1.0, 0.0)});
    State state = state_of(system);
    std::fill(state.tension_n.begin(), state.tension_n.end(), 10.0);
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        state.x_m[i] = 0.0;
        state.y_m[i] = -1.0 * static_cast<double>(i) / links;
    }
    ArrowExtents extents;
    extents.include(layer_of(system, Arrows::kTension).places().of(state), false);
    const ArrowLayer layer = layer_of(system, Arrows::kTension, extents);
    std::fill(state.tension_n.begin(), state.tension_n.end(), tension_n);
    DrawList list;
    list.width = list.height = static_cast<int>(kShorterPx);
    layer.draw(state, Camera(CameraDef{Vec2{}, 5.0}, Vec2{}, list.width, list.height), list);
    EXPECT_FALSE(list.capsules.empty());
    double top = kShorterPx;
    for (const Capsule& line : list.capsules)
        top = std::min(top, static_cast<double>(surroundings(line, line.radius).y0));
    return top;
}

TEST(Arrows, OfTensionEndBelowTheSupport) {
    // A link of 96 px, an arrow of 106, and ropes with an arrow near the pin.
    for (const int links : {1, 2, 3, 4, 12, 40})
        for (const double tension_n : {10.0, 7.0}) EXPECT_GT(top_px(links, tension_n), 241.0) << links;
}

TEST(Arrows, OfTensionInARopeDoNotTouchAndSpecksAreLeftOut) {
    const System rope = build_system(std::vector{reference::straight_rope(40, 4.0, 0.0)});
    State state = state_of(rope);
    ArrowExtents extents;
    extents.include(layer_of(rope, Arrows::kTension).places().of(state), false);
    const ArrowLayer layer = layer_of(rope, Arrows::kTension, extents);
    const double longest_m = 1.0;
    const std::vector<Arrow> apart = layer.places().of(state, longest_m);
    ASSERT_GE(apart.size(), 3U);
    EXPECT_LT(apart.size(), layer.places().of(state).size());
    for (std::size_t i = 1; i < apart.size(); ++i)
        EXPECT_GE(sim::length(apart[i].at_m.x - apart[i - 1].at_m.x, apart[i].at_m.y - apart[i - 1].at_m.y),
                  longest_m - 1e-9);
    const auto lines = [&] {
        DrawList list;
        list.width = list.height = static_cast<int>(kShorterPx);
        layer.draw(state, Camera(CameraDef{Vec2{}, 5.0}, rope.origin_m, list.width, list.height), list);
        return list.capsules.size();
    };
    EXPECT_GT(lines(), 0U);
    for (double& tension_n : state.tension_n) tension_n *= 0.01;
    EXPECT_EQ(lines(), 0U);
}

TEST(Arrows, ExtendAsFarAsTheyWereIncluded) {
    ArrowExtents extents;
    const Arrow arrows[] = {{{1.0, 2.0}, {3.0, 0.0}}, {{5.0, 2.0}, {-1e-3, 100.0}}, {{7.0, 2.0}, {}}};
    extents.include(arrows, false);
    std::vector<Drawn> drawn;
    extents.list(extents.longest(), 2.0, 0.5, drawn);
    double right_px = 0.0;
    double up_px = 0.0;
    for (const Drawn& one : drawn) {
        EXPECT_LT(one.bounds.max_m().x, 7.0);
        if (one.bounds.max_m().x == 1.0) right_px = std::max(right_px, one.right_px);
        up_px = std::max(up_px, one.up_px);
    }
    EXPECT_EQ(right_px, 2.0 * 3.0 + 0.5);
    EXPECT_GE(up_px, 2.0 * 100.0 + 0.5);
    EXPECT_LE(up_px, 2.0 * extents.longest() + 0.5);
    drawn.clear();
    extents.list(10.0, 2.0, 0.5, drawn);
    for (const Drawn& one : drawn) EXPECT_LE(one.up_px, 2.0 * 10.0 + 0.5);
}

TEST(Arrows, EndAtTheirPointsAndShrinkTheirHeads) {
    for (const double length_px : {2.0, 8.0, 100.0}) {
        DrawList list;
        list.width = list.height = 200;
        list.add_layer({});
        add_arrow({50.0, 60.0}, {50.0 + length_px, 60.0}, kShorterPx, false, false, list);
        double end_px = 0.0;
        double low_px = 200.0;
        for (const Capsule& line : list.capsules) {
            const Surroundings box = surroundings(line, line.radius);
            end_px = std::max(end_px, static_cast<double>(box.x1));
            low_px = std::min(low_px, static_cast<double>(box.x0));
        }
        EXPECT_NEAR(end_px, 50.0 + length_px, 0.01) << length_px;
        EXPECT_GE(low_px, 48.9) << length_px;  // the round end of the shaft
    }
    DrawList none;
    none.width = none.height = 200;
    none.add_layer({});
    add_arrow({50.0, 60.0}, {50.5, 60.0}, kShorterPx, false, false, none);
    EXPECT_TRUE(none.capsules.empty());
}

}  // namespace
}  // namespace corda::view
