#include "corda/sim/split.hpp"

#include <gtest/gtest.h>

#include "corda/reference/ropes.hpp"

namespace corda::sim {
namespace {

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

TEST(ABody, ThatIsAloneIsTheSystem) {
    const RopeDef rope = reference::straight_rope(4, 1.0, 30.0);
    const System system = build_system({&rope, 1});
    for_each_body(system, [&](const System& body, std::size_t) {
        EXPECT_EQ(body.x_m, system.x_m);
        EXPECT_EQ(body.bars.size(), system.bars.size());
    });
}

}  // namespace
}  // namespace corda::sim
