#include "corda/sim/work.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <vector>

#include "corda/reference/ropes.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

TEST(Work, VibrationsOfOneMassOnASpring) {
    RopeDef rope = reference::straight_rope(1, 0.5, 0.0);
    rope.mass_kg[1] = 4.0;
    rope.material.compliance_1_n = 0.01;
    const System system = build_system({&rope, 1});
    EXPECT_DOUBLE_EQ(vibration_frequency_1_s(system, system.bodies[0]), 1.0 / std::sqrt(0.01 * 0.5 * 4.0));
}

TEST(Work, VibrationsOfABodyAloneAndOfNoneThatIsRigidAndFlexible) {
    RopeDef soft = reference::straight_rope(3, 1.0, 0.0);
    soft.material.compliance_1_n = 1e-2;
    RopeDef stiff = soft;
    stiff.material.compliance_1_n = 1e-6;
    const RopeDef ropes[] = {soft, stiff, reference::straight_rope(3, 1.0, 0.0)};
    const System system = build_system(ropes);
    const double soft_1_s = vibration_frequency_1_s(system, system.bodies[0]);
    EXPECT_NEAR(vibration_frequency_1_s(system, system.bodies[1]) / soft_1_s, 100.0, 1e-10);
    EXPECT_EQ(vibration_frequency_1_s(system, system.bodies[2]), 0.0);
}

TEST(Work, VibrationsOfARopeThatResistsBending) {
    RopeDef rope = reference::straight_rope(4, 1.0, 0.0);
    rope.bending_n_m2 = 2.0;
    const System system = build_system({&rope, 1});
    // E I / a^3 = 128 N / m, times 16 / m for a wave of two links, and the margin for bends of 0.2 radians.
    const double square_1_s2 = std::pow(vibration_frequency_1_s(system, system.bodies[0]), 2.0);
    EXPECT_GT(square_1_s2, 128.0 * 15.0);
    EXPECT_LT(square_1_s2, 128.0 * 20.0);
}

TEST(Work, OfTheFastestBarAndTheShortestPendulum) {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}, {1.25, 0.0}});
    rope.velocity_m_s[1] = {0.0, 1.0};
    const System system = build_system({&rope, 1});
    EXPECT_DOUBLE_EQ(angular_velocity_1_s(system, system.bodies[0]), 4.0);
    WorldDef world;
    world.gravity_m_s2 = {3.0, -4.0};
    EXPECT_DOUBLE_EQ(pendulum_frequency_1_s(system, system.bodies[0], world), std::sqrt(5.0 / 0.25));
    EXPECT_DOUBLE_EQ(expected_steps(ExactDef{}, Body{}, 10.0, 3.0),
                     2.0 * expected_steps(ExactDef{}, Body{}, 5.0, 3.0));
}

TEST(Work, TensionsOfAPayloadMakeLightParticlesVibrate) {
    RopeDef rope = reference::straight_rope(20, 1.0, 40.0);
    rope.mass_kg.assign(21, 1e-3);
    rope.mass_kg.back() = 1e4;
    const System system = build_system({&rope, 1});
    const Forces forces{WorldDef{}};
    const double frequency_1_s = tension_frequency_1_s(system, system.bodies[0], forces);
    EXPECT_NEAR(frequency_1_s, std::sqrt(4.0 * 1e3 * 1e4 * forces.strength_m_s2() / 0.05),
                1e-3 * frequency_1_s);
    // An exact run takes 37189 steps in 1 s; the pendulum's frequency alone would tell 3.
    EXPECT_NEAR(expected_steps(ExactDef{}, system.bodies[0], frequency_1_s, 1.0), 17'700.0, 300.0);
}

TEST(Work, TensionsOfATurningRopeGrowWithItsSpeed) {
    const RopeDef slow = reference::spinning_rope(5, 1.0, 10.0);
    const RopeDef fast = reference::spinning_rope(5, 1.0, 1000.0);
    const auto frequency_1_s = [](const RopeDef& rope) {
        const System system = build_system({&rope, 1});
        return tension_frequency_1_s(system, system.bodies[0], WorldDef{{}, 10.0, 0.0});
    };
    EXPECT_NEAR(frequency_1_s(fast) / frequency_1_s(slow), 100.0, 1e-9);
}

TEST(Work, TensionsOfARopeThatHangsStillMoveNothing) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 180.0);
    const System system = build_system({&rope, 1});
    EXPECT_EQ(tension_frequency_1_s(system, system.bodies[0], WorldDef{}), 0.0);
}

TEST(Work, OfABodyIsEstimatedWithoutALookAtAllOthers) {
    RopeDef rope = reference::straight_rope(2, 1.0, 0.0);
    rope.bending_n_m2 = 1.0;
    const System system = build_system(std::vector<RopeDef>(50'000, rope));
    const auto start = std::chrono::steady_clock::now();
    double sum_1_s = 0.0;
    for (const Body& body : system.bodies) sum_1_s += vibration_frequency_1_s(system, body);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_GT(sum_1_s, 0.0);
    EXPECT_LT(taken.count(), 2.0);  // measured 0.1; 30 with a look at all
}

}  // namespace
}  // namespace corda::sim
