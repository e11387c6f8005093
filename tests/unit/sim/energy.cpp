#include "corda/sim/energy.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace corda::sim {
namespace {

/// Two free particles of 2 and 3 kg, 1 m apart, that a spring of 1/C = 500 N joins.
System spring_pair() {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {1.0, 0.0}};
    rope.mass_kg = {2.0, 3.0};
    rope.pinned.clear();
    rope.material.compliance_1_n = 1.0 / 500.0;
    return build_system(std::vector{rope});
}

TEST(EnergyMeter, AddsUpMotionWeightAndSprings) {
    const System system = spring_pair();
    const WorldDef world{.gravity_m_s2 = {0.0, -10.0}};
    const MethodDef method = ExactDef{};
    const State state{0.0, {0.0, 0.0}, {1.0, 3.0}, {1.0, 0.0}, {0.0, -2.0}, {}};
    const Energy energy = EnergyMeter(system, world, {&method, 1}).of(state);
    EXPECT_DOUBLE_EQ(energy.kinetic_j, 0.5 * 2.0 * 1.0 + 0.5 * 3.0 * 4.0);
    EXPECT_DOUBLE_EQ(energy.weight_j, 10.0 * (2.0 * 1.0 + 3.0 * 3.0));
    EXPECT_DOUBLE_EQ(energy.elastic_j, 0.5 * 500.0 * 1.0);  // stretched from 1 m to 2 m
    EXPECT_DOUBLE_EQ(energy.potential_j(), energy.weight_j + energy.elastic_j);
}

TEST(EnergyMeter, KnowsTheForceOfRelaxation) {
    const System system = spring_pair();
    RelaxationDef relaxation;
    relaxation.force_n = Vec2{4.0, 0.0};
    const MethodDef method = relaxation;
    const State state{0.0, {1.0, 2.0}, {5.0, 5.0}, {0.0, 0.0}, {0.0, 0.0}, {}};
    EXPECT_DOUBLE_EQ(EnergyMeter(system, {}, {&method, 1}).of(state).weight_j, -4.0 * (1.0 + 2.0));
}

}  // namespace
}  // namespace corda::sim
