#include "corda/sim/parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/events.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using testing::ElementsAre;

TEST(ConnectedParts, ArePathsChainsAndLooseParticles) {
    RopeDef ring = reference::rope_through({{0.0, 0.0}, {1.0, 0.2}, {1.5, -1.0}, {0.5, -1.5}, {-0.5, -0.8}});
    ring.closed = true;
    ring.bending_n_m2 = 1.0;
    ring.cuts = {{1, 0.5}};
    const System system = from_event_on(build_system({&ring, 1}), 0.5);
    const auto parts = connected_parts(system);
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_TRUE(parts[0].is_chain);
    EXPECT_THAT(parts[0].particles, ElementsAre(1, 0, 4, 3, 2));
    EXPECT_THAT(parts[0].bars, ElementsAre(0, 4, 3, 2));
    const System open = system_of(system, parts[0]);
    EXPECT_FALSE(open.has_events());
    ASSERT_EQ(open.bends.size(), 3U);
    for (std::uint32_t k = 0; k < 4; ++k) {
        EXPECT_EQ(open.bars[k].a, k);
        EXPECT_EQ(open.bars[k].b, k + 1);
    }
    for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(open.bends[k].b, k + 1);
}

TEST(ConnectedParts, OfANetKeepTheirGraph) {
    //  0-1-2
    //  | | |   without 1-4, 0-1, and 2-5: a triple 0-3-4-5 as a path, and 1-2
    NetDef net;
    for (int i = 0; i < 6; ++i) net.points_m.push_back({0.3 * (i % 3), -0.3 * (i / 3)});
    net.bars = {{0, 1}, {1, 2}, {3, 4}, {4, 5}, {0, 3}, {1, 4}, {2, 5}, {0, 4, false}, {1, 3, false}};
    net.pinned = {0, 2};
    net.cuts = {{0, 1.0}, {5, 2.0}, {6, 2.0}, {1, 3.0}};
    const System system = build_system({}, {&net, 1});
    EXPECT_EQ(system.cut_s[7], 1.0);  // a diagonal of a cell goes with its first side
    EXPECT_EQ(system.cut_s[8], 1.0);
    const auto two = connected_parts(from_event_on(system, 2.0));
    ASSERT_EQ(two.size(), 2U);
    EXPECT_THAT(two[0].particles, ElementsAre(0, 3, 4, 5));
    EXPECT_TRUE(two[0].is_chain);
    EXPECT_THAT(two[1].particles, ElementsAre(1, 2));
    const auto three = connected_parts(from_event_on(system, 3.0));
    ASSERT_EQ(three.size(), 2U);
    EXPECT_TRUE(three[1].is_loose);
    EXPECT_THAT(three[1].particles, ElementsAre(1, 2));
}

TEST(Cuts, TakeTheImaginaryBarsThatSpanTheLink) {
    RopeDef rope = reference::straight_rope(6, 1.0, 65.0);
    rope.reach = 3;
    rope.cuts = {{2, 1.0}, {4, 0.5}};
    const System system = build_system({&rope, 1});
    for (std::size_t k = 0; k < system.bars.size(); ++k) {
        const auto [a, b, reach, rest_m] = system.bars[k];
        const double expected = a <= 4 && 4 < b ? 0.5 : a <= 2 && 2 < b ? 1.0 : kNoEvent;
        EXPECT_EQ(system.cut_s[k], expected) << a << ' ' << b;
    }
    // Relaxation then moves two stiff rods.
    test::SolverRun<> run(rope, WorldDef{}, RelaxationDef{1e-3, 4});
    ASSERT_TRUE(run.go(3.0));
    EXPECT_LT(run.tip_y(), -20.0);
    EXPECT_GT(run.state().y_m[2], -1.1);
}

TEST(Events, AreCheckedWithTheBody) {
    const auto refused = [](const auto& change) {
        RopeDef rope = reference::straight_rope(3, 1.0, 30.0);
        change(rope);
        try {
            static_cast<void>(build_system({&rope, 1}));
        } catch (const Refusal& refusal) {
            return std::optional(refusal.reason());
        }
        return std::optional<Refusal::Reason>();
    };
    using Reason = Refusal::Reason;
    EXPECT_EQ(refused([](RopeDef& rope) { rope.releases = {{1, 0.0}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.releases = {{0, 0.0}, {0, 1.0}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.releases = {{0, -1.0}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.releases = {{0, HUGE_VAL}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.cuts = {{3, 0.0}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.cuts = {{1, 0.0}, {1, 1.0}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) { rope.cuts = {{1, NAN}}; }), Reason::kDefinition);
    EXPECT_EQ(refused([](RopeDef& rope) {
                  rope.points_m[3].x += 0.5;
                  rope.closed = true;
                  rope.cuts = {{1, 0.0}, {2, 1.0}};
              }),
              Reason::kDefinition);
}

}  // namespace
}  // namespace corda::sim
