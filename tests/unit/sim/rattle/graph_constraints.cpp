#include "corda/sim/rattle/graph_constraints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/system.hpp"
#include "support/nets.hpp"
#include "unit/sim/rattle/constraint_checks.hpp"

namespace corda::sim {
namespace {

/// A net of squares, with different masses, and a ring.
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

TEST(GraphConstraints, BoundTheFrequencyByThePullOnAParticle) {
    const System system = net_and_ring();
    const GraphConstraints constraints(system);
    std::vector<double> multiplier(constraints.links().size(), 0.0);
    multiplier[0] = -3.0;  // of the ring's unit masses 0, which is pinned, 1 and 2
    multiplier[1] = 5.0;
    EXPECT_DOUBLE_EQ(constraints.square_frequency(multiplier), 2.0 * 8.0);
}

TEST(GraphConstraints, LeaveOutBarsThatOthersImply) {
    for (const std::uint32_t size : {4U, 20U, 60U}) {
        NetDef net = test::leaning_net(size, size, 0.1, true);
        net.pinned = {};
        const GraphConstraints constraints(build_system({}, {&net, 1}));
        EXPECT_EQ(constraints.links().size(), 2 * size * size - 3) << size;  // a rigid body's
        EXPECT_FALSE(constraints.determines_tensions());
    }
    EXPECT_TRUE(GraphConstraints(net_and_ring()).determines_tensions());
}

TEST(GraphConstraints, MoveImpliedBarsToTheirLengthsToo) {
    const NetDef net = test::leaning_net(6, 5, 0.1, true);
    const System system = build_system({}, {&net, 1});
    GraphConstraints constraints(system);
    Motion motion = Motion::start_of(system);
    std::vector<double> impulse(constraints.links().size(), 0.0);
    ASSERT_TRUE(constraints.move({0.01, 0.9, {0.02, -0.05}}, motion, impulse));
    for (const Bar& bar : system.bars) {
        const double length_m =
            std::hypot(motion.x_m[bar.b] - motion.x_m[bar.a], motion.y_m[bar.b] - motion.y_m[bar.a]);
        EXPECT_NEAR(length_m / bar.rest_m, 1.0, 1e-13);
    }
}

TEST(GraphConstraints, MoveThreeParallelCranksUnderOneBeam) {
    // To first order the third crank says what two say, and so it stays: a bar that is implied by a special
    // shape.
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {0.5, -1.0}, {1.5, -1.0}, {2.5, -1.0}, {1.5, -2.0}};
    net.bars = {{0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {3, 6}, {4, 6}, {5, 6}};
    net.pinned = {0, 1, 2};
    const GraphConstraints constraints(build_system({}, {&net, 1}));
    EXPECT_EQ(constraints.links().size(), 7U);
}

TEST(GraphConstraints, RefuseBarsThatDependOnEachOtherAtTheStartAlone) {
    // A straight rope whose second bars make it a rod: to first order it could bend.
    RopeDef rope = reference::straight_rope(4, 1.0, 40.0);
    rope.reach = 2;
    try {
        const GraphConstraints constraints(build_system({&rope, 1}));
        ADD_FAILURE() << "not refused";
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kDependentBars);
    }
}

}  // namespace
}  // namespace corda::sim
