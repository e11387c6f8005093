#include "corda/sim/rattle/graph_constraints.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "corda/sim/refusal.hpp"
#include "support/constraint_checks.hpp"
#include "support/nets.hpp"

namespace corda::sim {
namespace {

/// A net of squares, with different masses, and a ring beside it.
System net_and_ring() {
    NetDef net = test::leaning_net(5, 4, 0.1);
    for (std::size_t i = 0; i < net.mass_kg.size(); ++i) net.mass_kg[i] = 0.5 + 0.25 * static_cast<double>(i);
    const RopeDef ring = test::ring(9);
    return build_system({&ring, 1}, {&net, 1});
}

TEST(GraphConstraints, SolveAsADenseMatrixDoes) {
    const System system = net_and_ring();
    GraphConstraints constraints(system);
    EXPECT_LT(test::error_of_solution(constraints, system), 1e-13);  // measured 2.8e-15
}

TEST(GraphConstraints, MoveByImpulsesAlongTheBarsToTheirLengths) {
    const System system = net_and_ring();
    GraphConstraints constraints(system);
    test::expect_impulses_along_the_bars(constraints, system);
}

TEST(GraphConstraints, GiveUpIfABarWouldTurnTooFar) {
    const System system = net_and_ring();
    GraphConstraints constraints(system);
    test::expect_to_give_up(constraints, system);
}

TEST(GraphConstraints, BoundTheFrequencyByWhatPullsAtAParticle) {
    const System system = net_and_ring();
    const GraphConstraints constraints(system);
    std::vector<double> multiplier(constraints.links().size(), 0.0);
    multiplier[0] = -3.0;  // of the ring's unit masses 0, which is pinned, 1 and 2
    multiplier[1] = 5.0;
    EXPECT_DOUBLE_EQ(constraints.square_frequency(multiplier), 2.0 * 8.0);
}

TEST(GraphConstraints, RefuseBarsThatDependOnEachOther) {
    const NetDef net = test::leaning_net(4, 4, 0.1, true);
    const System system = build_system({}, {&net, 1});
    try {
        const GraphConstraints constraints(system);
        ADD_FAILURE() << "not refused";
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kDependentBars);
    }
}

}  // namespace
}  // namespace corda::sim
