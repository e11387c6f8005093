#include "corda/sim/rattle/constraint_solver.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/rattle/chain_constraints.hpp"
#include "corda/sim/rattle/graph_constraints.hpp"
#include "support/nets.hpp"

namespace corda::sim {
namespace {

bool takes_chains(const System& system) {
    const auto solver = make_constraint_solver(system);
    const bool is_graph = dynamic_cast<GraphConstraints*>(solver.get()) != nullptr;
    EXPECT_NE(is_graph, dynamic_cast<ChainConstraints*>(solver.get()) != nullptr);
    return !is_graph;
}

TEST(MakeConstraintSolver, TakesTheChainSolverIfThereIsNoOtherBar) {
    RopeDef rope = reference::straight_rope(5, 1.0, 40.0);
    EXPECT_TRUE(takes_chains(build_system({&rope, 1})));
    const NetDef net = test::leaning_net(3, 3, 0.1);
    EXPECT_FALSE(takes_chains(build_system({&rope, 1}, {&net, 1})));
    const RopeDef ring = test::ring(5);
    EXPECT_FALSE(takes_chains(build_system({&ring, 1})));
    RopeDef soft_ring = ring;
    soft_ring.material.compliance_1_n = 1e-3;
    EXPECT_TRUE(takes_chains(build_system({&soft_ring, 1})));
}

TEST(ConstraintSolver, KeepsTheRigidBarsThatHaveAFreeEnd) {
    RopeDef ropes[] = {reference::straight_rope(4, 1.0, 40.0), reference::straight_rope(2, 1.0, 10.0)};
    ropes[0].pinned = {0, 1};
    ropes[1].material.compliance_1_n = 1e-3;
    const auto solver = make_constraint_solver(build_system(ropes));
    ASSERT_EQ(solver->links().size(), 3U);
    EXPECT_EQ(solver->links().front().a, 1U);
    EXPECT_EQ(solver->links().back().b, 4U);
    EXPECT_DOUBLE_EQ(solver->links().front().rest_m, 0.25);
}

TEST(AddUnrounded, LosesNothingOfAMillionSmallChanges) {
    double sum = 1.0;
    double lost = 0.0;
    double rounded = 1.0;
    for (int k = 0; k < 1'000'000; ++k) {
        add_unrounded(sum, lost, 1e-17);
        rounded += 1e-17;
    }
    EXPECT_EQ(rounded, 1.0);
    EXPECT_DOUBLE_EQ(sum, 1.0 + 1e-11);
}

TEST(Motion, StartsAsTheSystemDoesWithNothingLost) {
    RopeDef rope = reference::straight_rope(2, 1.0, 40.0);
    rope.velocity_m_s = {{1.0, 2.0}, {3.0, 4.0}, {5.0, 6.0}};
    const System system = build_system({&rope, 1});
    const Motion motion = Motion::start_of(system);
    EXPECT_EQ(motion.x_m, system.x_m);
    EXPECT_EQ(motion.y_m, system.y_m);
    EXPECT_EQ(motion.vx_m_s, (std::vector{0.0, 3.0, 5.0}));
    EXPECT_EQ(motion.vy_m_s, (std::vector{0.0, 4.0, 6.0}));
    const std::vector<double> none(3, 0.0);
    EXPECT_EQ(motion.x_lost_m, none);
    EXPECT_EQ(motion.vy_lost_m_s, none);
}

std::ptrdiff_t held(const NetDef& net) {
    const std::vector<double> inverse_mass_1_kg =
        inverse_masses_with_taut_rows_held(build_system({}, {&net, 1}));
    return std::count(inverse_mass_1_kg.begin(), inverse_mass_1_kg.end(), 0.0);
}

TEST(TautRows, HoldTheRowBetweenTwoPinnedCorners) {
    EXPECT_EQ(held(test::cloth(8, 6, 0.1)), 8);
    NetDef inner = test::cloth(8, 6, 0.1);
    inner.pinned = {1, 5};
    EXPECT_EQ(held(inner), 5);
}

TEST(TautRows, HoldWhatHeldRowsHold) {
    NetDef net = test::cloth(7, 5, 0.3);
    net.pinned = {0, 6, 28, 34};
    EXPECT_EQ(held(net), 35);
}

TEST(TautRows, HoldFarFromTheOriginAndAfterRounding) {
    NetDef net = test::cloth(30, 30, 0.1);
    net.pinned = {0, 29, 885};
    const std::ptrdiff_t here = held(net);
    EXPECT_GT(here, 31);
    for (Vec2& point : net.points_m) point = point + Vec2{100.1, 33.3};
    EXPECT_EQ(held(net), here);
    System system = build_system({}, {&net, 1});
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        if (!system.is_pinned(i)) system.x_m[i] += sign * 2.2e-16 * largest_length_m(system);
    }
    const std::vector<double> moved = inverse_masses_with_taut_rows_held(system);
    EXPECT_EQ(std::count(moved.begin(), moved.end(), 0.0), here);
}

TEST(TautRows, MayMoveAsFarAsTheirArchAllows) {
    const auto play_m = [](const NetDef& net) { return play_of_taut_rows_m(build_system({}, {&net, 1})); };
    NetDef net = test::cloth(4, 3, 0.25);
    EXPECT_EQ(play_m(net), 0.0);
    // By the lengths of its bars, the row's corner reaches 1.2e-8 m above and below the line.
    net.points_m[1].y += 1e-8;
    net.points_m[2].y += 1e-8;
    EXPECT_EQ(held(net), 4);
    EXPECT_GT(play_m(net), 2e-8);
    EXPECT_LT(play_m(net), 3e-8);
    // A row that ends at this row has what the first one yields.
    NetDef crossed = test::cloth(3, 5, 0.25);
    crossed.pinned = {0, 2, 13};
    EXPECT_EQ(play_m(crossed), 0.0);
    crossed.points_m[1].y += 1e-8;
    EXPECT_GT(play_m(crossed), 1e-4);
}

TEST(TautRows, LeaveRowsThatCanMove) {
    NetDef net = test::cloth(8, 6, 0.1);
    net.pinned = {0};
    EXPECT_EQ(held(net), 1);
    net = test::cloth(8, 6, 0.1);
    net.points_m[3].y -= 1e-6;  // sagging: longer than the pins' distance by 1e-11 of it
    EXPECT_EQ(held(net), 2);
}

}  // namespace
}  // namespace corda::sim
