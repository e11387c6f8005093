#include "corda/sim/rattle/chain_constraints.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/system.hpp"
#include "unit/sim/rattle/constraint_checks.hpp"

namespace corda::sim {
namespace {

/// Particles on a zigzag of unequal links and masses.
RopeDef zigzag(std::uint32_t links, std::vector<std::uint32_t> pinned) {
    std::vector<Vec2> points_m;
    for (std::uint32_t i = 0; i <= links; ++i)
        points_m.push_back({0.1 * i + 0.01 * i * i, i % 2 ? -0.2 : 0.1});
    RopeDef rope = reference::rope_through(std::move(points_m));
    for (std::size_t i = 0; i < rope.mass_kg.size(); ++i)
        rope.mass_kg[i] = 0.5 + 0.25 * static_cast<double>(i);
    rope.pinned = std::move(pinned);
    return rope;
}

/// Chains of every kind: a free one, and one cut by pins into a loose end, a span and another loose end.
System chains() {
    const RopeDef ropes[] = {zigzag(5, {}), zigzag(12, {3, 8})};
    return build_system(ropes);
}

TEST(ChainConstraints, SuitBarsFromEachParticleToTheNext) {
    const Bar first{0, 1, 1, 1.0};
    const Bar second{1, 2, 1, 1.0};
    const Bar apart{5, 6, 1, 1.0};
    const Bar longer{0, 2, 1, 1.0};
    using Bars = std::vector<Bar>;
    EXPECT_TRUE(ChainConstraints::suits({}));
    EXPECT_TRUE(ChainConstraints::suits(Bars{first, second, apart}));
    EXPECT_FALSE(ChainConstraints::suits(Bars{second, first}));
    EXPECT_FALSE(ChainConstraints::suits(Bars{first, longer}));
}

TEST(ChainConstraints, SolveAsADenseMatrixDoes) {
    const System system = chains();
    ChainConstraints constraints(system);
    EXPECT_LT(test::error_of_solution(constraints, system), 1e-13);
}

TEST(ChainConstraints, MoveByImpulsesAlongTheBarsToTheirLengths) {
    const System system = chains();
    ChainConstraints constraints(system);
    test::expect_impulses_along_the_bars(constraints, system);
}

TEST(ChainConstraints, GiveUpIfABarWouldTurnTooFar) {
    const System system = chains();
    ChainConstraints constraints(system);
    test::expect_to_give_up(constraints, system);
}

TEST(ChainConstraints, BoundTheFrequencyByThePullOnAParticle) {
    const RopeDef rope = zigzag(3, {0});  // masses 0.75, 1 and 1.25 kg after the pin
    const System system = build_system({&rope, 1});
    const ChainConstraints constraints(system);
    EXPECT_DOUBLE_EQ(constraints.square_frequency(std::vector{2.0, -1.0, 0.0}), 2.0 * (2.0 + 1.0) / 0.75);
    EXPECT_DOUBLE_EQ(constraints.square_frequency(std::vector{0.0, 0.0, 5.0}), 2.0 * 5.0 / 1.0);
}

TEST(ChainConstraints, CarryTheMassBeyondEachLinkFromThePin) {
    const auto carried = [](std::vector<std::uint32_t> pinned) {
        const RopeDef rope = zigzag(3, std::move(pinned));  // masses 0.5, 0.75, 1 and 1.25 kg
        const System system = build_system({&rope, 1});
        return ChainConstraints(system).carried_mass(system.mass_kg);
    };
    EXPECT_EQ(carried({0}), (std::vector{3.0, 2.25, 1.25}));
    EXPECT_EQ(carried({3}), (std::vector{0.5, 1.25, 2.25}));
    EXPECT_EQ(carried({0, 3}), (std::vector{1.75, 1.75, 1.75}));
    EXPECT_EQ(carried({}), (std::vector{0.0, 0.0, 0.0}));
    EXPECT_EQ(carried({1}), (std::vector{0.5, 2.25, 1.25}));
}

TEST(ChainConstraints, RefuseAChainThatIsStraightBetweenTwoPins) {
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.pinned = {0, 10};
    try {
        const ChainConstraints constraints(build_system({&rope, 1}));
        ADD_FAILURE() << "not refused";
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kTautBetweenPins);
    }
    rope.points_m[5].y -= 1e-3;
    EXPECT_NO_THROW(ChainConstraints(build_system({&rope, 1})));
}

}  // namespace
}  // namespace corda::sim
