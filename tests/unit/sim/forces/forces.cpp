#include "corda/sim/forces/forces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/relaxation/relaxation.hpp"

namespace corda::sim {
namespace {

TEST(Forces, AreTheSumOfGravityAndDrag) {
    WorldDef world;
    world.gravity_m_s2 = {3.0, -4.0};
    world.drag_1_s = 0.7;
    const Forces forces(world);
    EXPECT_EQ(forces.uniform_m_s2(), (Vec2{3.0, -4.0}));
    EXPECT_EQ(forces.strength_m_s2(), 5.0);
    EXPECT_EQ(forces.drag_1_s(), 0.7);
    EXPECT_FALSE(forces.conserve_energy());
    EXPECT_TRUE(Forces(WorldDef{}).conserve_energy());
    EXPECT_EQ(forces.potential_j_kg({2.0, 1.0}), -2.0);
    EXPECT_EQ(forces.inverse_timescale_1_s(0.2, 0.5), 5.0);
    EXPECT_EQ(forces.inverse_timescale_1_s(0.2, 2.0), 10.0);
}

TEST(Forces, DescribeThemselvesAndNameParametersOutOfRange) {
    WorldDef world;
    std::vector<std::string> texts;
    for (const ForceKind& kind : force_kinds()) {
        EXPECT_EQ(kind.problem(world), nullptr);
        texts.push_back(kind.text(world));
    }
    EXPECT_EQ(texts, (std::vector<std::string>{"gravity of (0, -9.81) m/s2", "", "", ""}));
    world = {{}, 10.0, -1.0};
    EXPECT_EQ(force_kinds()[0].text(world), "no gravity");
    EXPECT_STREQ(force_kinds()[1].problem(world), "drag_1_s is not >= 0");
    world.wind_m_s = {2.0, 0.0};
    world.gusts = {{1.0, 0.5}, 0.25, 30.0};
    EXPECT_EQ(force_kinds()[2].text(world), "wind of (2, 0) m/s");
    EXPECT_EQ(force_kinds()[3].text(world), "gusts of (1, 0.5) m/s at 0.25 Hz");
    world.gusts.frequency_hz = 1e6;
    EXPECT_STREQ(force_kinds()[3].problem(world), "frequency_hz is not within its range");
}

TEST(Forces, OfAMovingFrameAreLessItsAccelerationAndWind) {
    WorldDef world;
    world.drag_1_s = 0.5;
    world.wind_m_s = {3.0, 1.0};
    world.gusts = {{1.0, 0.0}, 0.7, 10.0};
    TimeFunction displacement;
    displacement.add_wave({{0.2, -0.1}, 0.9, 50.0});
    const TimeFunction velocity = displacement.derivative();
    const TimeFunction acceleration = velocity.derivative();
    Forces forces(world);
    Forces there = forces.seen_from(displacement);
    EXPECT_FALSE(there.conserve_energy());
    EXPECT_EQ(there.weight_m_s2(), (Vec2{0.0, -9.81}));
    Forces later = there.from(0.6);
    std::array<Vec2, 3> series{};
    for (const double t : {0.0, 0.8, 2.3}) {
        forces.set_time(t);
        there.set_time(t);
        later.set_time(t - 0.6);
        const Vec2 off = forces.uniform_m_s2() - acceleration(t) - 0.5 * velocity(t) - there.uniform_m_s2();
        EXPECT_LT(length(off.x, off.y), 1e-14);
        EXPECT_LE(length(there.uniform_m_s2().x, there.uniform_m_s2().y), there.strength_m_s2());
        EXPECT_NEAR(later.uniform_m_s2().x, there.uniform_m_s2().x, 1e-14);
        there.expand(t, 0.1, series);
        EXPECT_NEAR(series[0].x, there.uniform_m_s2().x, 1e-14);
    }
}

TEST(Forces, DecayIsTheExponentialToRounding) {
    double largest_error = 0.0;
    for (const double drag_1_s : {1e-9, 0.3, 1.0, 17.0}) {
        const Forces forces(ForceTerm{{}, drag_1_s});
        for (double time_s = -2.0; time_s <= 30.0; time_s += 0.0625) {
            const double expected = std::exp(-drag_1_s * time_s);
            largest_error = std::max(largest_error, std::abs(forces.decay(time_s) / expected - 1.0));
        }
    }
    std::printf("decay: off by %.1e\n", largest_error);
    // Squaring doubles a rounding error, up to eleven times.
    EXPECT_LT(largest_error, 1e-12);  // measured 3.1e-13
    EXPECT_EQ(Forces(WorldDef{}).decay(5.0), 1.0);
    EXPECT_EQ(Forces(ForceTerm{{}, 1e300}).decay(1.0), 0.0);
}

TEST(Forces, ActOnFreeParticlesInProportionToTheirMass) {
    RopeDef rope = reference::straight_rope(3, 6.0, 0.0);
    rope.mass_kg = {7.0, 1.0, 2.0, 4.0};
    rope.payload_kg = 1.0;
    const RopeDef ropes[] = {rope, reference::straight_rope(1, 0.5, 30.0)};
    const System system = build_system(ropes);
    WorldDef world;
    world.gravity_m_s2 = {0.0, -10.0};
    const std::vector<Vec2> force_n = Forces(world).on_particles(system);
    EXPECT_EQ(force_n, (std::vector<Vec2>{{}, {0, -10}, {0, -20}, {0, -50}, {}, {0, -10}}));
    EXPECT_DOUBLE_EQ(energy_scale_j(system, force_n), 80.0 * 6.0 + 10.0 * 0.5);
}

TEST(Forces, GiveAllMethodsTheSameEnergyScale) {
    RopeDef rope = reference::straight_rope(5, 2.0, 40.0);
    rope.payload_kg = 3.0;
    const System system = build_system({&rope, 1});
    const double expected_j = 9.81 * 8.0 * 2.0;
    EXPECT_DOUBLE_EQ(Exact::make(system, WorldDef{}, ExactDef{})->energy_scale_j(), expected_j);
    EXPECT_DOUBLE_EQ(Rattle(system, WorldDef{}, RattleDef{}, 0.01).energy_scale_j(), expected_j);
    EXPECT_DOUBLE_EQ(Relaxation(system, WorldDef{}, RelaxationDef{}, 0.01).energy_scale_j(), expected_j);
    RelaxationDef with_force;
    with_force.force_n = Vec2{0.0, -2.0};
    EXPECT_DOUBLE_EQ(Relaxation(system, WorldDef{}, with_force, 0.01).energy_scale_j(), 2.0 * 5.0 * 2.0);
}

}  // namespace
}  // namespace corda::sim
