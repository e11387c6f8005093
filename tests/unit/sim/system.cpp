#include "corda/sim/system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/defs.hpp"
#include "support/failure.hpp"

namespace corda::sim {
namespace {

using testing::ElementsAre;

TEST(BarCount, IsTheReportsSevenTimesNLessTwentyEight) {
    EXPECT_EQ(bar_count(20, 7), 112U);
    EXPECT_EQ(bar_count(40, 7), 252U);
    EXPECT_EQ(bar_count(80, 7), 532U);
    EXPECT_EQ(bar_count(100, 7), 672U);
}

TEST(BarCount, AReachBeyondTheRopeAddsNoBars) {
    EXPECT_EQ(bar_count(3, 7), 3U);
    EXPECT_EQ(bar_count(2, 1), 1U);
    EXPECT_EQ(bar_count(5, 4), bar_count(5, 1000));
}

TEST(System, HasTheBarsThatBarCountPromises) {
    for (const int particles : {2, 3, 7, 8, 20, 100}) {
        for (const int reach : {1, 2, 7, 10}) {
            RopeDef rope = reference::report_rope(particles);
            rope.reach = reach;
            const System system = build_system({&rope, 1});
            EXPECT_EQ(system.bars.size(), bar_count(particles, reach))
                << particles << " particles, reach " << reach;
            EXPECT_EQ(system.link_count(), static_cast<std::size_t>(particles - 1));
        }
    }
}

TEST(System, OrdersBarsByReachAndThenAlongTheRope) {
    RopeDef rope = reference::report_rope(4);
    rope.reach = 2;
    const System system = build_system({&rope, 1});
    ASSERT_EQ(system.bars.size(), 5U);
    const std::array<std::array<unsigned, 3>, 5> expected{
        {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {0, 2, 2}, {1, 3, 2}}};
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(system.bars[i].a, expected[i][0]);
        EXPECT_EQ(system.bars[i].b, expected[i][1]);
        EXPECT_EQ(system.bars[i].reach, expected[i][2]);
    }
}

TEST(System, PullsInAStringThatIsTooShortForItsPoints) {
    RopeDef rope = reference::rope_through({{0, 0}, {0, -1}, {0, -1}, {1, -1}});
    rope.material.is_string = true;
    rope.rest_m = {0.5, 0.5, 0.5};
    const System hung = build_system({&rope, 1});
    EXPECT_THAT(hung.x_m, ElementsAre(0.0, 0.0, 0.0, 0.5));
    EXPECT_THAT(hung.y_m, ElementsAre(0.0, -0.5, -0.5, -0.5));
    rope.pinned = {3};  // pulled towards the other end
    const System held = build_system({&rope, 1});
    EXPECT_THAT(held.x_m, ElementsAre(0.5, 0.5, 0.5, 1.0));
    EXPECT_THAT(held.y_m, ElementsAre(-0.5, -1.0, -1.0, -1.0));
    rope.pinned = {1, 2};  // links outside of the pins alone
    const System between = build_system({&rope, 1});
    EXPECT_THAT(between.x_m, ElementsAre(0.0, 0.0, 0.0, 0.5));
    EXPECT_THAT(between.y_m, ElementsAre(-0.5, -1.0, -1.0, -1.0));
    rope.pinned = {0, 2};  // pins hold the first link longer than it can be, for a solver to refuse
    EXPECT_EQ(build_system({&rope, 1}).bars[0].rest_m, 0.5);
}

TEST(System, PullsNoLinkBeyondItsLength) {
    RopeDef rope = reference::rope_through({{0, 0}, {0.3, -1.1}, {0.7, -1.9}, {1.3, -2.3}, {1.9, -2.2}});
    rope.material.is_string = true;
    rope.rest_m = {0.7, 2.0, 0.1, std::sqrt(0.37)};
    const System system = build_system({&rope, 1});
    for (std::size_t k = 0; k < rope.rest_m.size(); ++k) {
        const Bar& bar = system.bars[k];
        const double distance_m =
            length(system.x_m[bar.b] - system.x_m[bar.a], system.y_m[bar.b] - system.y_m[bar.a]);
        EXPECT_LE(distance_m, bar.rest_m) << k;
        EXPECT_NEAR(bar.rest_m, rope.rest_m[k], 1e-15) << k;
    }
}

TEST(System, KeepsRopesWithinTheirLength) {
    RopeDef rope = reference::rope_through({{-0.0, 0}, {0, -1}, {1, -1}});
    rope.material.is_string = true;
    rope.rest_m = {1.0, 2.0};
    EXPECT_FALSE(pulled_in(rope).has_value());
    EXPECT_THAT(build_system({&rope, 1}).x_m, ElementsAre(0.0, 0.0, 1.0));
    rope.material.compliance_1_n = 1e-3;  // it stretches
    rope.rest_m = {0.5, 0.5};
    EXPECT_FALSE(pulled_in(rope).has_value());
}

TEST(System, SharesItsArraysAmongRopes) {
    RopeDef first = reference::straight_rope(3, 3.0, 0.0);
    RopeDef second = reference::straight_rope(2, 1.0, 90.0);
    first.origin_m = {10.0, 20.0};
    second.origin_m = {11.0, 20.0};
    second.payload_kg = 5.0;
    second.pinned = {1};
    second.velocity_m_s = {{1.0, 2.0}, {3.0, 4.0}, {5.0, 6.0}};
    const std::array<RopeDef, 2> ropes{first, second};
    const System system = build_system(ropes);
    ASSERT_EQ(system.particle_count(), 7U);
    ASSERT_EQ(system.bars.size(), 5U);
    EXPECT_EQ(system.origin_m, (Vec2{10.0, 20.0}));
    EXPECT_EQ(system.x_m[4], 1.0);  // the second rope stands 1 m to the right of the first one's origin
    EXPECT_EQ(system.bodies[1].first_particle, 4U);
    EXPECT_EQ(system.bars[3].a, 4U);
    EXPECT_EQ(system.mass_kg[6], 6.0);
    EXPECT_EQ(system.bodies[0].payload_kg, 0.0);
    EXPECT_EQ(system.bodies[1].payload_kg, 5.0);
    EXPECT_TRUE(system.is_pinned(5));
    EXPECT_EQ(system.vx_m_s[5], 0.0);  // a pinned particle has no velocity
    EXPECT_EQ(system.vy_m_s[6], 6.0);
    EXPECT_EQ(system.inverse_mass_1_kg[6], 1.0 / 6.0);
}

TEST(BarCount, OfAClosedRopeHasEachBarOnce) {
    EXPECT_EQ(bar_count(3, 1, true), 3U);
    EXPECT_EQ(bar_count(3, 7, true), 3U);  // a triangle has no more
    EXPECT_EQ(bar_count(4, 2, true), 6U);  // a square and its diagonals
    EXPECT_EQ(bar_count(5, 2, true), 10U);
    EXPECT_EQ(bar_count(6, 3, true), 15U);
    EXPECT_EQ(bar_count(100, 7, true), 700U);
}

TEST(System, OfAClosedRopeHasTheBarsThatBarCountPromises) {
    for (const int particles : {3, 4, 5, 6, 7, 20}) {
        for (const int reach : {1, 2, 3, 10}) {
            RopeDef rope = reference::report_rope(particles);
            rope.closed = true;
            rope.reach = reach;
            const System system = build_system({&rope, 1});
            EXPECT_EQ(system.bars.size(), bar_count(particles, reach, true))
                << particles << " particles, reach " << reach;
            EXPECT_EQ(system.link_count(), static_cast<std::size_t>(particles));
            EXPECT_FALSE(system.bodies[0].is_chain);
            std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
            for (const Bar& bar : system.bars) pairs.insert(std::minmax(bar.a, bar.b));
            EXPECT_EQ(pairs.size(), system.bars.size());
        }
    }
}

TEST(System, OfARopeThatBendsHasACornerAtEveryInnerParticle) {
    RopeDef rope = reference::report_rope(4);
    rope.points_m = {{0.0, 0.0}, {1.0, 0.0}, {1.0, -3.0}, {-4.0, -3.0}};
    rope.bending_n_m2 = 6.0;
    const System open = build_system({&rope, 1});
    ASSERT_EQ(open.bends.size(), 2U);
    EXPECT_EQ(open.bends[0].b, 1U);
    EXPECT_EQ(open.bends[0].stiffness_n_m, 3.0);  // E I over the mean of 1 m and 3 m
    EXPECT_EQ(open.bends[1].stiffness_n_m, 1.5);
    rope.closed = true;
    const System closed = build_system({&rope, 1});
    ASSERT_EQ(closed.bends.size(), 4U);
    EXPECT_EQ(closed.bends[3].a, 3U);
    EXPECT_EQ(closed.bends[3].b, 0U);
    EXPECT_EQ(closed.bends[3].c, 1U);
    EXPECT_EQ(closed.bends[3].stiffness_n_m, 2.0);  // between 5 m and 1 m
}

TEST(System, PutsNetsAfterTheRopes) {
    const RopeDef rope = reference::straight_rope(2, 2.0, 0.0);
    NetDef net;
    net.origin_m = {10.0, 1.0};
    net.points_m = {{0.0, 0.0}, {3.0, 0.0}, {3.0, -4.0}};
    net.mass_kg = {1.0, 2.0, 4.0};
    net.velocity_m_s = {{1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}};
    net.bars = {{0, 1}, {1, 2}, {0, 2, false}};
    net.pinned = {1};
    net.material.compliance_1_n = 0.5;
    const System system = build_system({&rope, 1}, {&net, 1});
    ASSERT_EQ(system.bodies.size(), 2U);
    const Body& body = system.bodies[1];
    EXPECT_TRUE(body.is_net);
    EXPECT_FALSE(body.is_chain);
    EXPECT_FALSE(system.bodies[0].is_net);
    EXPECT_TRUE(system.bodies[0].is_chain);
    EXPECT_EQ(body.first_particle, 3U);
    EXPECT_EQ(body.first_bar, 2U);
    EXPECT_EQ(body.bar_count, 3U);
    EXPECT_EQ(body.link_count, 2U);
    EXPECT_EQ(body.material.compliance_1_n, 0.5);
    EXPECT_EQ(system.link_count(), 4U);
    EXPECT_EQ(system.x_m[3], 10.0);
    EXPECT_EQ(system.y_m[5], -3.0);
    EXPECT_EQ(system.bars[4].a, 3U);
    EXPECT_EQ(system.bars[4].b, 5U);
    EXPECT_EQ(system.bars[4].rest_m, 5.0);
    EXPECT_NE(system.bars[4].reach, 1U);  // imaginary
    EXPECT_TRUE(system.is_pinned(4));
    EXPECT_EQ(system.vx_m_s[4], 0.0);
    EXPECT_EQ(system.vx_m_s[5], 3.0);
    EXPECT_EQ(build_system({}, {&net, 1}).origin_m, net.origin_m);
}

TEST(Bodies, AreSystemsOfTheirOwn) {
    RopeDef beam = reference::straight_rope(3, 1.0, 20.0);
    beam.bending_n_m2 = 2.0;
    beam.origin_m = {5.0, 1.0};
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    net.bars = {{0, 1}, {1, 2}, {0, 2, false}};
    net.pinned = {2};
    net.mass_kg = {1.0, 2.0, 3.0};
    net.velocity_m_s = {{1.0, 2.0}, {3.0, 4.0}, {}};
    const RopeDef ropes[] = {reference::straight_rope(2, 1.0, 0.0), beam};
    const System system = build_system(ropes, {&net, 1});
    std::size_t seen = 0;
    for_each_body(system, [&](const System& body, std::size_t i) {
        EXPECT_EQ(i, seen++);
        EXPECT_EQ(body.origin_m, system.origin_m);
        ASSERT_EQ(body.bodies.size(), 1U);
        const Body& whole = system.bodies[i];
        EXPECT_EQ(body.bodies.front().first_particle, 0U);
        EXPECT_EQ(body.bodies.front().is_net, i == 2);
        ASSERT_EQ(body.particle_count(), whole.particle_count);
        for (std::size_t k = 0; k < whole.particle_count; ++k) {
            EXPECT_EQ(body.x_m[k], system.x_m[whole.first_particle + k]);
            EXPECT_EQ(body.vy_m_s[k], system.vy_m_s[whole.first_particle + k]);
            EXPECT_EQ(body.mass_kg[k], system.mass_kg[whole.first_particle + k]);
            EXPECT_EQ(body.is_pinned(k), system.is_pinned(whole.first_particle + k));
        }
        ASSERT_EQ(body.bars.size(), whole.bar_count);
        for (std::size_t k = 0; k < whole.bar_count; ++k) {
            EXPECT_EQ(body.bars[k].a + whole.first_particle, system.bars[whole.first_bar + k].a);
            EXPECT_EQ(body.bars[k].reach, system.bars[whole.first_bar + k].reach);
        }
        ASSERT_EQ(body.bends.size(), i == 1 ? 2U : 0U);
        if (i == 1) {
            EXPECT_EQ(body.bends[1].c, 3U);
        }
    });
    EXPECT_EQ(seen, 3U);
}

TEST(ABody, ThatIsTheOnlyOneIsTheSystem) {
    const RopeDef rope = reference::straight_rope(4, 1.0, 30.0);
    const System system = build_system({&rope, 1});
    for_each_body(system, [&](const System& body, std::size_t) {
        EXPECT_EQ(body.x_m, system.x_m);
        EXPECT_EQ(body.bars.size(), system.bars.size());
    });
}

/// The message for a valid rope after a change.
std::string problem_of_rope(const std::function<void(RopeDef&)>& spoil) {
    RopeDef ropes[] = {reference::straight_rope(3, 1.0, 20.0), reference::straight_rope(3, 1.0, 30.0)};
    spoil(ropes[1]);
    return test::failure_of([&] { static_cast<void>(build_system(ropes)); }).message;
}

/// The message for a valid net of three particles after a change.
std::string problem_of_net(const std::function<void(NetDef&)>& spoil) {
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    net.bars = {{0, 1}, {1, 2}, {0, 2, false}};
    spoil(net);
    return test::failure_of([&] { static_cast<void>(build_system({}, {&net, 1})); }).message;
}

TEST(CheckedBodies, AcceptValidBodiesAndRefuseAnEmptyScene) {
    EXPECT_EQ(problem_of_rope([](RopeDef&) {}), "");
    EXPECT_EQ(problem_of_net([](NetDef&) {}), "");
    EXPECT_EQ(test::failure_of([] { static_cast<void>(build_system({}, {})); }).message,
              "scene: there is neither a rope nor a net");
}

TEST(CheckedBodies, NameTheRopeAndTheField) {
    static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const std::pair<std::function<void(RopeDef&)>, const char*> faults[] = {
        {[](RopeDef& rope) { rope.points_m.resize(1); }, "points_m has fewer"},
        {[](RopeDef& rope) { rope.origin_m.x = kInfinity; }, "origin_m"},
        {[](RopeDef& rope) { rope.points_m[2].y = kNaN; }, "points_m"},
        {[](RopeDef& rope) { rope.mass_kg.resize(3, 1.0); }, "mass_kg needs one"},
        {[](RopeDef& rope) { rope.mass_kg.assign(4, 0.0); }, "mass_kg has"},
        {[](RopeDef& rope) { rope.velocity_m_s.resize(3); }, "velocity_m_s needs"},
        {[](RopeDef& rope) {
             rope.velocity_m_s.assign(4, {kNaN, 0.0});
         },
         "velocity_m_s has"},
        {[](RopeDef& rope) {
             rope.pinned = {0, 4};
         },
         "pinned names particle 4 of 4"},
        {[](RopeDef& rope) { rope.material.compliance_1_n = -1.0; }, "compliance_1_n"},
        {[](RopeDef& rope) { rope.reach = 0; }, "reach"},
        {[](RopeDef& rope) { rope.payload_kg = -1.0; }, "payload_kg"},
        {[](RopeDef& rope) { rope.bending_n_m2 = kInfinity; }, "bending_n_m2"},
        {[](RopeDef& rope) { rope.rest_m.assign(4, 1.0); }, "rest_m needs"},
        {[](RopeDef& rope) { rope.rest_m.assign(3, 0.0); }, "rest_m has"},
        {[](RopeDef& rope) {
             rope.points_m.resize(2);
             rope.mass_kg = {};
             rope.velocity_m_s = {};
             rope.closed = true;
         },
         "closed needs at least 3"},
    };
    for (const auto& [spoil, words] : faults) {
        const std::string problem = problem_of_rope(spoil);
        EXPECT_THAT(problem, testing::StartsWith("rope 1: "));
        EXPECT_THAT(problem, testing::HasSubstr(words));
    }
    EXPECT_EQ(problem_of_rope([](RopeDef& rope) {
                  rope.closed = true;
                  rope.rest_m.assign(4, 1.0);
              }),
              "");
}

TEST(CheckedBodies, NameTheNetAndTheBar) {
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({0, 3, false});
                }),
                testing::AllOf(testing::StartsWith("net 0: "), testing::HasSubstr("(0, 3)")));
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({1, 1, false});
                }),
                testing::HasSubstr("(1, 1)"));
    EXPECT_THAT(problem_of_net([](NetDef& net) {
                    net.bars.push_back({2, 1});
                }),
                testing::HasSubstr("a real bar behind an imaginary one"));
    EXPECT_THAT(problem_of_net([](NetDef& net) { net.mass_kg = {1.0}; }), testing::HasSubstr("mass_kg"));
}

}  // namespace
}  // namespace corda::sim
