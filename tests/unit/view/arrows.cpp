#include "corda/view/arrows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "corda/reference/ropes.hpp"

namespace corda::view {
namespace {

constexpr double kShorterPx = 480.0;
constexpr Vec2 kGravity{0.0, -10.0};

ArrowLayer layer_of(const System& system, Arrows kind) {
    StyleDef style;
    style.arrows = kind;
    return {system, kGravity, style, kShorterPx};
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
    const std::vector<Arrow> arrows = layer_of(system, Arrows::kVelocity).of(state_of(system));
    ASSERT_EQ(arrows.size(), 3U);  // the first particle is pinned
    EXPECT_EQ(arrows[0].value, (Vec2{3.0, -4.0}));
    EXPECT_TRUE(layer_of(system, Arrows::kNone).of(state_of(system)).empty());
}

TEST(Arrows, ShowWeights) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.mass_kg = {1.0, 0.5};
    const System system = build_system(std::vector{rope});
    const std::vector<Arrow> arrows = layer_of(system, Arrows::kWeight).of(state_of(system));
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
        for (const Arrow& arrow : layer_of(system, Arrows::kTension).of(state)) all.push_back(arrow.value);
        return all;
    };
    EXPECT_EQ(values(), (std::vector<Vec2>{{0.0, 2.0}, {-2.0, 0.0}, {0.0, -2.0}}));
    state.tension_n.back() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(values().size(), 1U);
    const System chain = build_system(std::vector{reference::straight_rope(10, 1.0, 0.0)});
    EXPECT_EQ(layer_of(chain, Arrows::kTension).of(state_of(chain)).size(), 10U);
}

TEST(Arrows, AreFewOnManyParticlesAndOnManyBodies) {
    const System rope = build_system(std::vector{reference::straight_rope(1000, 1.0, 0.0)});
    const std::vector<Arrow> along = layer_of(rope, Arrows::kVelocity).of(state_of(rope));
    EXPECT_EQ(along.size(), 12U);
    EXPECT_EQ(along.front().at_m, (Vec2{rope.x_m.back(), rope.y_m.back()}));
    const System many = build_system(std::vector<RopeDef>(200, reference::straight_rope(2, 1.0, 0.0)));
    const std::size_t count = layer_of(many, Arrows::kVelocity).of(state_of(many)).size();
    EXPECT_LE(count, 60U);
    EXPECT_GE(count, 40U);
}

TEST(Arrows, HaveTheLongestAtAShareOfThePicture) {
    const System system = build_system(std::vector{reference::straight_rope(1, 1.0, 0.0)});
    ArrowLayer layer = layer_of(system, Arrows::kVelocity);
    ArrowExtents extents;
    for (const Arrow& arrow : layer.of(state_of(system))) extents.include(arrow);
    EXPECT_EQ(extents.largest(), 5.0);
    layer.set_extents(extents);
    EXPECT_DOUBLE_EQ(layer.pixels_per_unit(), 0.22 * kShorterPx / 5.0);
    DrawList list;
    list.width = list.height = static_cast<int>(kShorterPx);
    const CameraDef camera{Vec2{}, 4.0};
    layer.draw(state_of(system), Camera(camera, system.origin_m, list.width, list.height), list);
    ASSERT_EQ(list.layers.size(), 1U);
    EXPECT_TRUE(list.layers[0].is_note);
    EXPECT_GT(list.capsules[0].length, 0.9F * 0.22F * 480.0F);
}

TEST(Arrows, OfTensionInARopeDoNotTouchAndSpecksAreLeftOut) {
    const System rope = build_system(std::vector{reference::straight_rope(40, 4.0, 0.0)});
    State state = state_of(rope);
    ArrowLayer layer = layer_of(rope, Arrows::kTension);
    ArrowExtents extents;
    for (const Arrow& arrow : layer.of(state)) extents.include(arrow);
    layer.set_extents(extents);
    const double longest_m = 1.0;
    const std::vector<Arrow> apart = layer.of(state, longest_m);
    ASSERT_GE(apart.size(), 3U);
    EXPECT_LT(apart.size(), layer.of(state).size());
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
    extents.include({{1.0, 2.0}, {3.0, 0.0}});
    extents.include({{5.0, 2.0}, {-1e-3, 100.0}});
    extents.include({{7.0, 2.0}, {}});
    std::vector<Drawn> drawn;
    extents.list(2.0, 0.5, drawn);
    double right_px = 0.0;
    double up_px = 0.0;
    for (const Drawn& one : drawn) {
        EXPECT_LT(one.bounds.max_m().x, 7.0);
        if (one.bounds.max_m().x == 1.0) right_px = std::max(right_px, one.right_px);
        up_px = std::max(up_px, one.up_px);
    }
    EXPECT_EQ(right_px, 2.0 * 3.0 + 0.5);
    EXPECT_GE(up_px, 2.0 * 100.0 + 0.5);
    EXPECT_LE(up_px, 2.0 * extents.largest() + 0.5);
}

TEST(Arrows, EndAtTheirPointsAndShrinkTheirHeads) {
    for (const double length_px : {2.0, 8.0, 100.0}) {
        DrawList list;
        list.width = list.height = 200;
        list.add_layer({});
        add_arrow({50.0, 60.0}, {50.0 + length_px, 60.0}, kShorterPx, false, list);
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
    add_arrow({50.0, 60.0}, {50.5, 60.0}, kShorterPx, false, none);
    EXPECT_TRUE(none.capsules.empty());
}

}  // namespace
}  // namespace corda::view
