// Rigid bars in any graph by method `exact`, held against `rattle`, which shares the matrix and nothing else.

#include "corda/sim/exact/bar_dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/nets.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A net whose cells are no parallelograms, on the ends of its top row, which sags.
NetDef uneven_net(bool diagonals = false) {
    NetDef net = test::leaning_net(5, 4, 0.2, diagonals);
    for (NetBar& bar : net.bars) bar.is_real = true;
    for (std::uint32_t i = 0; i + 1 < 5; ++i) net.bars.push_back({i, i + 1});
    for (std::size_t i = 0; i < net.points_m.size(); ++i) {
        const auto order = static_cast<double>(i);
        net.points_m[i].x += 0.02 * std::sin(7.0 * order);
        net.points_m[i].y += 0.02 * std::cos(3.0 * order) - (i > 0 && i < 4 ? 0.05 : 0.0);
        net.mass_kg[i] = 0.5 + 0.3 * static_cast<double>(i % 5);
        net.velocity_m_s[i] = {0.5 * std::sin(3.0 * order), 0.5 * std::cos(5.0 * order)};
    }
    net.pinned = {0, 4};
    return net;
}

/// Also checks lengths and, without drag, energy.
void expect_as_rattle(const NetDef& net, const WorldDef& world, bool tells_tensions = true) {
    test::SolverRun<> run(net, world, ExactDef{1e-12});
    test::SolverRun<> other(net, world, RattleDef{8, 5e-4});
    std::vector<double> tension_n(net.bars.size());
    std::vector<double> other_tension_n(net.bars.size());
    for (int k = 0; k <= 3; ++k) {
        ASSERT_TRUE(run.go(0.1 * k) && other.go(0.1 * k)) << k;
        EXPECT_LT(run.distance_m(other.state()), 1e-10) << k;
        ASSERT_EQ(run.solver().tensions(tension_n), tells_tensions);
        if (!tells_tensions) continue;
        ASSERT_TRUE(other.solver().tensions(other_tension_n));
        for (std::size_t i = 0; i < tension_n.size(); ++i)
            EXPECT_NEAR(tension_n[i], other_tension_n[i], 1e-7) << i;
    }
    EXPECT_LT(run.strain(), 1e-14);
    if (world.drag_1_s == 0.0) {
        EXPECT_LT(run.energy_error(), 1e-11);
    }
    EXPECT_GT(run.moved_m(), 0.01);
}

TEST(BarDynamics, MovesANetAsRattle) {
    expect_as_rattle(uneven_net(), WorldDef{});
}

TEST(BarDynamics, MovesANetWithDragAsRattle) {
    WorldDef world;
    world.drag_1_s = 0.7;
    expect_as_rattle(uneven_net(), world);
}

TEST(BarDynamics, MovesANetWithoutAPinAsRattle) {
    NetDef net = uneven_net();
    net.pinned = {};
    expect_as_rattle(net, WorldDef{});
}

TEST(BarDynamics, LeavesOutBarsThatOthersImply) {
    NetDef net = uneven_net(true);
    net.pinned = {0};
    expect_as_rattle(net, WorldDef{}, false);
}

TEST(BarDynamics, MovesAClosedRope) {
    const RopeDef ring = test::ring(12);
    test::SolverRun<> run(ring, WorldDef{}, ExactDef{1e-12});
    test::SolverRun<> other(ring, WorldDef{}, RattleDef{8, 5e-4});
    EXPECT_LT(test::largest_distance_m(run, other, 5), 1e-9);
}

TEST(BarDynamics, RefusesBending) {
    RopeDef ring = test::ring(12);
    ring.bending_n_m2 = 1.0;
    EXPECT_EQ(test::refusal_of(build_system({&ring, 1}), ExactDef{}), Refusal::Reason::kRigidGraph);
}

}  // namespace
}  // namespace corda::sim
