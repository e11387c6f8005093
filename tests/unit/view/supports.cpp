#include "corda/view/supports.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <utility>

#include "benchmark/study/reference/ropes.hpp"
#include "support/draw_list_of.hpp"
#include "support/draw_lists.hpp"

namespace corda::view {
namespace {

constexpr double kSidePx = 1000.0;
constexpr std::size_t kPlateCapsules = 1 + 7;
constexpr std::size_t kRingCapsules = 64;

/// The supports of a system whose particles go from their start to `higher_m` above it, at 100 pixels per
/// metre.
DrawList draw(const System& system, Vec2 gravity_m_s2, double higher_m = 0.0, double line_px = 4.0,
              double time_s = 0.0, std::optional<double> first_s = {}) {
    std::vector<MotionBounds> motion;
    State state{0.0, system.x_m, system.y_m};
    test::include(state, motion);
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (!system.is_pinned(i)) state.y_m[i] += higher_m;
    }
    test::include(state, motion);
    DrawList list;
    list.width = 1000;
    list.height = 1000;
    list.add_layer({});
    Supports(system, gravity_m_s2, motion, kSidePx, std::array{line_px})
        .draw(State{time_s, system.x_m, system.y_m}, first_s.value_or(time_s),
              Camera({Vec2{0.0, 0.0}, 10.0}, {}, 1000, 1000), list);
    return list;
}

System rope_of(std::vector<Vec2> points_m, std::vector<std::uint32_t> pinned) {
    RopeDef rope;
    rope.points_m = std::move(points_m);
    rope.pinned = std::move(pinned);
    return build_system({{rope}}, {});
}

TEST(Supports, ArePlatesUnlessSomethingRisesAboveThePin) {
    const System system = rope_of({{0.0, 0.0}, {0.3, -1.0}}, {0});
    EXPECT_EQ(draw(system, {0.0, -9.81}).capsules.size(), kPlateCapsules);
    EXPECT_EQ(draw(system, {0.0, -9.81}, 1.0).capsules.size(), kPlateCapsules);  // just as high
    EXPECT_EQ(draw(system, {0.0, -9.81}, 1.1).capsules.size(), kRingCapsules);
    EXPECT_EQ(draw(system, {0.0, 0.0}).capsules.size(), kRingCapsules);  // there is no above
    EXPECT_EQ(draw(system, {0.0, 9.81}).capsules.size(), kRingCapsules);
}

TEST(Supports, OfPinsAtTwoHeightsAreAPlateAndARing) {
    const System system = rope_of({{0.0, 0.0}, {1.0, -2.0}, {2.0, -1.0}}, {0, 2});
    EXPECT_EQ(draw(system, {0.0, -9.81}).capsules.size(), kPlateCapsules + kRingCapsules);
}

TEST(Supports, LeanAgainstGravity) {
    const System system = rope_of({{0.0, 0.0}, {0.0, 0.0}}, {0});
    struct Case {
        Vec2 gravity_m_s2;
        PixelRect bounds;
    };
    // 90 pixels along, 4.2 + 20 pixels of plate and hatch above, and the slack of bounds.
    for (const Case& c : {Case{{0.0, -9.81}, {451, 472, 549, 504}},
                          {{0.0, 9.81}, {451, 496, 549, 528}},
                          {{9.81, 0.0}, {472, 451, 504, 549}},
                          {{-9.81, 0.0}, {496, 451, 528, 549}}}) {
        const PixelRect bounds = test::bounds_of(draw(system, c.gravity_m_s2));
        EXPECT_NEAR(bounds.x0, c.bounds.x0, 2);
        EXPECT_NEAR(bounds.y0, c.bounds.y0, 2);
        EXPECT_NEAR(bounds.x1, c.bounds.x1, 2);
        EXPECT_NEAR(bounds.y1, c.bounds.y1, 2);
    }
}

TEST(Supports, ThatTouchAreOnePlate) {
    // 0.9 m are the length of a plate.
    const std::size_t apart =
        draw(rope_of({{0.0, 0.0}, {0.5, -1.0}, {0.91, 0.0}}, {0, 2}), {0.0, -9.81}).capsules.size();
    EXPECT_EQ(apart, 2 * kPlateCapsules);
    const DrawList joined = draw(rope_of({{0.0, 0.0}, {0.5, -1.0}, {0.7, 0.0}}, {2, 0}), {0.0, -9.81});
    EXPECT_EQ(joined.capsules.size(), 1U + 13U);  // 160 pixels
    EXPECT_NEAR(joined.capsules[0].length, 160.0F - 1000.0F / 240.0F, 1e-2);
}

TEST(Supports, HideTheRoundEndsOfWideLines) {
    const System system = rope_of({{0.0, 0.0}, {0.3, -1.0}}, {0});
    for (const auto& [line_px, plate_px] : {std::pair{4.0, 1000.0 / 240.0}, {8.0, 8.0}, {60.0, 12.5}}) {
        EXPECT_FLOAT_EQ(draw(system, {0.0, -9.81}, 0.0, line_px).capsules[0].radius,
                        static_cast<float>(0.5 * plate_px));
    }
    const DrawList ring = draw(system, {}, 0.0, 60.0);
    EXPECT_GT(test::bounds_of(ring).width(), 120);
}

TEST(Supports, MergeTheParticlesOfAClamp) {
    const System system = rope_of({{0.0, 0.0}, {0.1, -0.1}, {0.2, -0.5}}, {0, 1});
    EXPECT_EQ(draw(system, {0.0, -9.81}).capsules.size(), kPlateCapsules);
}

TEST(Supports, OfThousandsOfPinsAreDots) {
    NetDef net;
    for (std::uint32_t i = 0; i <= 1000; ++i) {
        net.points_m.push_back({0.0, -0.001 * i});
        net.pinned.push_back(i);
        if (i > 0) net.bars.push_back({i - 1, i});
    }
    EXPECT_EQ(draw(build_system({}, {{net}}), {0.0, -9.81}).capsules.size(), 1001U);
}

TEST(Supports, AreGoneOnceTheirPinsAreLetGo) {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {1.0, -2.0}, {2.0, -1.0}};
    rope.pinned = {0, 2};
    rope.releases = {{0, 1.0}, {2, 2.0}};
    const auto at = [&](double time_s, std::optional<double> first_s = {}) {
        return draw(build_system({{rope}}, {}), {0.0, -9.81}, 0.0, 4.0, time_s, first_s).capsules.size();
    };
    EXPECT_EQ(at(0.9), kPlateCapsules + kRingCapsules);
    EXPECT_EQ(at(1.0), kRingCapsules);
    EXPECT_EQ(at(2.0), 0U);
    // Of several poses, those of the first have them; a ring that moved would be elsewhere.
    EXPECT_EQ(at(3.0, 0.5), kPlateCapsules + kRingCapsules);
    EXPECT_EQ(at(3.0, 1.5), kRingCapsules);
    rope.moves = {{2, {{{0.1, 0.0}, 1.0, 0.0}}, {}}};
    EXPECT_EQ(at(3.0, 1.5), 0U);
    EXPECT_EQ(at(1.5), kRingCapsules);
}

TEST(Supports, OfAClampStayWithTheLastOfItsPins) {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {0.5, 0.0}, {1.0, -2.0}};
    rope.pinned = {0, 1};
    const auto at = [&](double time_s) {
        return draw(build_system({{rope}}, {}), {0.0, -9.81}, 0.0, 4.0, time_s).capsules.size();
    };
    EXPECT_EQ(at(0.0), kPlateCapsules);
    rope.releases = {{0, 1.0}};
    EXPECT_EQ(at(1.0), kPlateCapsules);
}

TEST(Supports, AreListedAsDrawn) {
    const System system = rope_of({{0.0, 0.0}, {0.3, -1.0}}, {0});
    std::vector<MotionBounds> motion;
    test::include({0.0, system.x_m, system.y_m}, motion);
    std::vector<Drawn> drawn;
    Supports(system, {0.0, -9.81}, motion, kSidePx, std::array{4.0}).list(drawn);
    ASSERT_EQ(drawn.size(), 1U);
    EXPECT_DOUBLE_EQ(drawn[0].left_px, 45.0);
    EXPECT_DOUBLE_EQ(drawn[0].right_px, 45.0);
    EXPECT_NEAR(drawn[0].up_px, 26.7, 0.1);
    EXPECT_DOUBLE_EQ(drawn[0].down_px, 0.0);
}

}  // namespace
}  // namespace corda::view
