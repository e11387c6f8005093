#include "corda/sim/exact/chain_bending.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "unit/sim/exact/chains.hpp"

namespace corda::sim {
namespace {

struct Bent {
    explicit Bent(const std::vector<std::uint32_t>& pinned, double bending_n_m2 = 2.0) {
        RopeDef rope = test::chain_rope();
        rope.pinned = pinned;
        rope.bending_n_m2 = bending_n_m2;
        system = build_system({&rope, 1});
        const Chains chains = make_chains(system, system.bodies, WorldDef{});
        length_m = chains.length_m;
        y = chains.start;
        bending = ChainBending(system, chains.links, length_m);
    }
    System system;
    std::vector<double> length_m;
    std::vector<double> y;
    ChainBending bending;
};

TEST(ChainBending, HasCouplesThatAreTheGradientOfItsEnergy) {
    // A chain alone; chains that bend at a pin, in either direction; and one that two pins clamp.
    const std::vector<std::uint32_t> pins[] = {{}, {0}, {8}, {4}, {0, 4}, {2, 3}, {0, 1}, {7, 8}};
    for (const std::vector<std::uint32_t>& pinned : pins) {
        Bent bent(pinned);
        ASSERT_FALSE(bent.bending.empty());
        bent.bending.find_couples(bent.y.data());
        const std::vector<double> couple_n = bent.bending.couple_n();
        const std::size_t links = bent.length_m.size();
        double largest_n = 0.0;
        for (std::size_t i = 0; i < links; ++i) {
            const auto energy_j = [&](double angle) {
                std::vector<double> y = bent.y;
                y[i] = std::cos(angle) * bent.y[i] - std::sin(angle) * bent.y[links + i];
                y[links + i] = std::sin(angle) * bent.y[i] + std::cos(angle) * bent.y[links + i];
                return bent.bending.energy_j(y.data());
            };
            constexpr double kAngle = 1e-5;
            const double torque_n_m = -(energy_j(kAngle) - energy_j(-kAngle)) / (2.0 * kAngle);
            EXPECT_NEAR(couple_n[i] * bent.length_m[i], torque_n_m, 1e-7) << i << " of " << links;
            largest_n = std::max(largest_n, std::abs(couple_n[i]));
        }
        EXPECT_GT(largest_n, 1.0);
    }
}

TEST(ChainBending, HasNoEnergyAndNoCouplesIfTheRopeIsStraight) {
    RopeDef rope = reference::straight_rope(4, 1.0, 30.0);
    rope.bending_n_m2 = 3.0;
    rope.pinned = {2};
    const System system = build_system({&rope, 1});
    ChainDynamics dynamics(system, system.bodies, WorldDef{{0.0, 0.0}});
    std::vector<double> slope(dynamics.initial_state().size());
    dynamics.derivative(dynamics.initial_state().data(), slope.data());
    for (const double change : slope) EXPECT_NEAR(change, 0.0, 1e-13);
    EXPECT_NEAR(dynamics.energy_j(dynamics.initial_state().data()), 0.0, 1e-14);
}

TEST(ChainBending, IsEmptyIfNothingBends) {
    EXPECT_TRUE(Bent({0}, 0.0).bending.empty());
    EXPECT_TRUE(ChainBending().empty());
}

TEST(ChainBending, KnowsTheRigidityAtItsLinks) {
    const Bent bent({0});
    for (std::size_t i = 0; i < bent.length_m.size(); ++i)
        EXPECT_NEAR(bent.bending.rigidity_n_m2(i), 2.0, 1e-14) << i;
}

}  // namespace
}  // namespace corda::sim
