// Positions, velocities, energy and loads of the states of a ChainDynamics.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "support/chains.hpp"

namespace corda::sim {
namespace {

constexpr test::Pins kAllPins[] = {test::Pins::kNone, test::Pins::kStart, test::Pins::kEnd,
                                   test::Pins::kBoth};

struct Moving {
    explicit Moving(const System& given, const WorldDef& world = {})
        : system(given), dynamics(system, system.bodies, world) {}
    [[nodiscard]] State positions(const std::vector<double>& y) const {
        State state{0.0, std::vector<double>(system.particle_count(), NAN),
                    std::vector<double>(system.particle_count(), NAN)};
        dynamics.positions(y.data(), state);
        return state;
    }
    System system;
    ChainDynamics dynamics;
};

TEST(ChainOutputs, StartAtThePositionsOfTheSystem) {
    for (const test::Pins pins : kAllPins) {
        const Moving moving(test::chain(pins));
        const State state = moving.positions(moving.dynamics.initial_state());
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            EXPECT_NEAR(state.x_m[i], moving.system.x_m[i], 1e-15) << i;
            EXPECT_NEAR(state.y_m[i], moving.system.y_m[i], 1e-15) << i;
        }
    }
}

TEST(ChainOutputs, HaveVelocitiesThatAreTheChangeOfThePositions) {
    for (const test::Pins pins : kAllPins) {
        Moving moving(test::chain(pins));
        const std::vector<double>& y = moving.dynamics.initial_state();
        std::vector<double> slope(y.size());
        moving.dynamics.derivative(y.data(), slope.data());
        constexpr double kStep = 1e-6;
        std::vector<double> later = y;
        std::vector<double> earlier = y;
        for (std::size_t i = 0; i < y.size(); ++i) {
            later[i] += kStep * slope[i];
            earlier[i] -= kStep * slope[i];
        }
        const State ahead = moving.positions(later);
        const State behind = moving.positions(earlier);
        std::vector<double> vx(test::kChainParticles);  // 0 of pinned particles, which are not written
        std::vector<double> vy(test::kChainParticles);
        moving.dynamics.velocities(y.data(), vx, vy);
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            EXPECT_NEAR(vx[i], (ahead.x_m[i] - behind.x_m[i]) / (2.0 * kStep), 1e-8) << i;
            EXPECT_NEAR(vy[i], (ahead.y_m[i] - behind.y_m[i]) / (2.0 * kStep), 1e-8) << i;
        }
    }
}

TEST(ChainOutputs, HaveTheEnergyOfTheirParticles) {
    const WorldDef world{{1.5, -9.81}, 1.0, 0.0};
    for (const test::Pins pins : kAllPins) {
        const Moving moving(test::chain(pins), world);
        const std::vector<double>& y = moving.dynamics.initial_state();
        const State state = moving.positions(y);
        std::vector<double> vx(test::kChainParticles);
        std::vector<double> vy(test::kChainParticles);
        moving.dynamics.velocities(y.data(), vx, vy);
        double energy_j = 0.0;
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            if (moving.system.is_pinned(i)) continue;
            energy_j += moving.system.mass_kg[i] * (0.5 * (vx[i] * vx[i] + vy[i] * vy[i]) -
                                                    dot(world.gravity_m_s2, {state.x_m[i], state.y_m[i]}));
        }
        EXPECT_NEAR(moving.dynamics.energy_j(y.data()), energy_j, 1e-12);
    }
}

TEST(ChainOutputs, HaveTheLoadsOfAHangingRope) {
    // Two sides hang from the pin in the middle: 1.5 and 2 kg.
    RopeDef rope = reference::rope_through({{0.0, -2.0}, {0.0, -1.0}, {0.0, 0.0}, {0.0, -0.5}});
    rope.mass_kg = {0.5, 1.0, 7.0, 2.0};
    rope.pinned = {2};
    Moving moving(build_system({&rope, 1}));
    const Loads loads = moving.dynamics.loads(moving.dynamics.initial_state().data());
    EXPECT_NEAR(loads.largest_tension_n, 2.0 * 9.81, 1e-13);
    EXPECT_NEAR(loads.pin_force_n, 3.5 * 9.81, 1e-13);
    std::vector<double> tension_n;
    moving.dynamics.tensions(moving.dynamics.initial_state().data(), tension_n);
    EXPECT_NEAR(tension_n[0], 0.5 * 9.81, 1e-13);
    EXPECT_NEAR(tension_n[1], 1.5 * 9.81, 1e-13);
}

TEST(ChainOutputs, HaveTheForceOfAClampAtItsPins) {
    // A link that two pins hold, and one that is bent from it by a right angle: a torque of 3 N m on links of
    // 1 m.
    RopeDef rope = reference::rope_through({{-1.0, 0.0}, {0.0, 0.0}, {0.0, -1.0}});
    rope.pinned = {0, 1};
    rope.bending_n_m2 = 3.0;
    Moving moving(build_system({&rope, 1}), WorldDef{{0.0, 0.0}, 1.0, 0.0});
    // Its couples are 3 N at the ends of each link, across it; at the second pin they meet at a right angle.
    const Loads loads = moving.dynamics.loads(moving.dynamics.initial_state().data());
    EXPECT_NEAR(loads.pin_force_n, std::hypot(3.0, 3.0), 1e-12);
    EXPECT_NEAR(loads.largest_tension_n, 0.0, 1e-12);
}

}  // namespace
}  // namespace corda::sim
