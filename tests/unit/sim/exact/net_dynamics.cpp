// Nets by method `exact`, held against `rattle`: positions, velocities and tensions from Cartesian
// coordinates with a multiplier per bar.

#include "corda/sim/exact/net_dynamics.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "corda/core/cancel.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "support/nets.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A grid of squares without diagonals, pinned at its upper left corner.
NetDef grid(std::uint32_t columns, std::uint32_t rows, double spacing_m) {
    NetDef net = test::cloth(columns, rows, spacing_m);
    std::erase_if(net.bars, [](const NetBar& bar) { return !bar.is_real; });
    net.pinned = {0};
    return net;
}

/// Gives every particle a mass and a velocity of its own. Bars may not keep their lengths in these
/// velocities.
NetDef stirred(NetDef net) {
    for (std::size_t i = 0; i < net.points_m.size(); ++i) {
        const auto order = static_cast<double>(i);
        net.mass_kg[i] = 0.5 + 0.3 * static_cast<double>(i % 5);
        net.velocity_m_s[i] = {0.5 * std::sin(3.0 * order), 0.5 * std::cos(5.0 * order)};
    }
    return net;
}

/// A parallelogram linkage on two pins, from which a triangle hangs.
NetDef linkage() {
    NetDef net;
    net.points_m = {{0.0, 0.0}, {0.6, 0.0}, {0.3, -0.5}, {0.9, -0.5}, {0.5, -0.9}, {0.6, -1.2}, {0.4, -1.3}};
    net.bars = {{0, 2}, {1, 3}, {2, 3}, {2, 4}, {3, 4}, {4, 5}, {5, 6}, {4, 6}};
    net.mass_kg.assign(net.points_m.size(), 1.0);
    net.velocity_m_s.assign(net.points_m.size(), {});
    net.pinned = {0, 1};
    return net;
}

void expect_as_rattle(const NetDef& net, const WorldDef& world, bool tells_tensions) {
    test::SolverRun<> net_run(net, world, ExactDef{1e-12});
    test::SolverRun<> bar_run(net, world, RattleDef{8, 5e-4});
    std::vector<double> tension_n(net.bars.size());
    std::vector<double> tension_of_bars_n(net.bars.size());
    for (int k = 0; k <= 3; ++k) {
        ASSERT_TRUE(net_run.go(0.1 * k) && bar_run.go(0.1 * k)) << k;
        EXPECT_LT(net_run.distance_m(bar_run.state()), 1e-10) << k;  // 3e-12
        const std::vector<double> none(net.points_m.size());
        State of_net{0.0, {}, {}, none, none};
        State of_bars = of_net;
        net_run.solver().velocities(of_net);
        bar_run.solver().velocities(of_bars);
        for (std::size_t i = 0; i < none.size(); ++i) {
            EXPECT_NEAR(of_net.vx_m_s[i], of_bars.vx_m_s[i], 1e-8) << k << ' ' << i;  // 3e-9
            EXPECT_NEAR(of_net.vy_m_s[i], of_bars.vy_m_s[i], 1e-8) << k << ' ' << i;  // 2e-9
        }
        EXPECT_NEAR(net_run.solver().energy_j(), bar_run.solver().energy_j(), 1e-7)
            << k;  // 1.6e-8, of rattle
        ASSERT_EQ(net_run.solver().tensions(tension_n), tells_tensions) << k;
        ASSERT_EQ(bar_run.solver().tensions(tension_of_bars_n), tells_tensions) << k;
        for (std::size_t i = 0; i < tension_n.size() && tells_tensions; ++i)
            EXPECT_NEAR(tension_n[i], tension_of_bars_n[i], 2e-8 * (100.0 + std::abs(tension_n[i])))
                << k << ' ' << i;  // 1.2e-8
    }
    EXPECT_LT(net_run.strain(), 1e-13);
}

TEST(NetDynamics, MovesAGridAsItsBarsDo) {
    WorldDef world;
    expect_as_rattle(grid(5, 4, 0.2), world, true);
    world.drag_1_s = 0.4;
    expect_as_rattle(stirred(grid(4, 5, 0.2)), world, true);
}

TEST(NetDynamics, MovesAFreeGridAsItsBarsDo) {
    NetDef net = stirred(grid(4, 3, 0.2));
    net.pinned = {};
    expect_as_rattle(net, WorldDef{}, true);
}

TEST(NetDynamics, MovesANetOnSeveralPinsAsItsBarsDo) {
    expect_as_rattle(test::leaning_net(4, 5, 0.2), WorldDef{}, true);
    expect_as_rattle(linkage(), WorldDef{}, true);
}

TEST(NetDynamics, HoldsARowThatIsTautBetweenTwoPins) {
    NetDef net = grid(6, 4, 0.2);
    net.pinned = {1, 3};
    expect_as_rattle(stirred(net), WorldDef{}, false);
}

TEST(NetDynamics, SwingsAPlateWithoutTensions) {
    NetDef net = test::cloth(5, 4, 0.2);
    net.pinned = {2};
    expect_as_rattle(net, WorldDef{}, false);
}

TEST(NetDynamics, SwingsARodOfTrianglesInLine) {
    NetDef rod;
    rod.points_m = {{0.0, 0.0}, {0.6, 0.8}, {0.3, 0.4}};  // upwards: its period depends on all three
    rod.bars = {{0, 2}, {2, 1}, {0, 1}};
    rod.pinned = {0};
    rod.velocity_m_s = {{}, {0.8, -0.6}, {0.4, -0.3}};
    test::SolverRun<> run(rod, WorldDef{}, ExactDef{1e-12});
    ASSERT_TRUE(run.go(2.0, 20));
    EXPECT_FALSE(run.loads().has_value());
    EXPECT_LT(run.strain(), 1e-14);
    EXPECT_LT(run.energy_error(), 1e-12);
}

TEST(NetDynamics, StandsStillIfEveryBarIsHeld) {
    test::SolverRun<> run(test::cloth(4, 3, 0.2), WorldDef{}, ExactDef{});
    ASSERT_TRUE(run.go(10.0));
    EXPECT_EQ(run.moved_m(), 0.0);
}

TEST(NetDynamics, KeepsTheBitsOfAGridOf30By30) {
    test::SolverRun<> run(grid(30, 30, 0.1), WorldDef{}, ExactDef{1e-6});
    ASSERT_TRUE(run.go(0.25));
    std::uint64_t hash = 14695981039346656037U;  // FNV-1a, by words
    for (const auto* part : {&run.state().x_m, &run.state().y_m}) {
        for (const double x : *part) hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211U;
    }
    EXPECT_EQ(hash, 3300129949250324325U);
}

TEST(NetDynamics, IsPreparedAndEliminatedInPartsThatCanBeCancelled) {
    NetDef large = grid(150, 150, 0.01);
    const System system = build_system({}, {&large, 1});
    for (std::uint32_t i = 1; i < 150; ++i) large.pinned.push_back(i);
    const System curtain = build_system({}, {&large, 1});
    const auto expect_cancelled = [](const auto& work) {
        const CancelScope never = test::cancel_after(0);
        EXPECT_EQ(test::code_of(work), ExitCode::kInterrupted);
    };
    expect_cancelled([&] { static_cast<void>(inverse_masses_with_taut_rows_held(curtain)); });
    expect_cancelled([&] { BarGroups(system, system.inverse_mass_1_kg); });

    NetDynamics net(system, Forces(WorldDef{}));  // 298 groups, which take a cube of products
    std::vector<double> slope(net.initial_state().size());
    int checks = 0;
    const CancelScope count([&checks] { return ++checks > 0; });
    net.derivative(net.initial_state().data(), slope.data());
    EXPECT_GE(checks, 2);

    // A cancellation at any check reaches the caller.
    const auto make = [&] { NetDynamics(system, Forces(WorldDef{})); };
    checks = 0;
    make();
    const int all = checks;
    EXPECT_GE(all, 4);
    for (int back = 1; back <= all; back *= 2) {  // the last ones are of the elimination
        const CancelScope ends = test::cancel_after(all - back);
        EXPECT_EQ(test::code_of(make), ExitCode::kInterrupted) << back;
    }
}

TEST(NetDynamics, RefusesWhatIsNoNetOfGroups) {
    const auto reason = [](const NetDef& net) -> std::optional<Refusal::Reason> {
        try {
            NetDynamics(build_system({}, {&net, 1}), Forces(WorldDef{}));
        } catch (const Refusal& refused) {
            return refused.reason();
        }
        return std::nullopt;
    };
    NetDef net = grid(4, 4, 0.2);
    EXPECT_EQ(reason(net), std::nullopt);
    net.pinned = {0, 15};  // the groups must close between the pins
    EXPECT_EQ(reason(net), Refusal::Reason::kRigidGraph);
    net = grid(4, 4, 0.2);
    net.points_m[5].x += 1e-6;  // no parallelogram
    EXPECT_EQ(reason(net), Refusal::Reason::kRigidGraph);
    net = grid(2, 2, 0.2);
    net.points_m.push_back({9.0, 9.0});  // in two parts
    net.mass_kg.push_back(1.0);
    net.velocity_m_s.push_back({});
    EXPECT_EQ(reason(net), Refusal::Reason::kRigidGraph);
    net = grid(300, 1, 0.01);  // 299 groups of one bar each
    EXPECT_EQ(reason(net), Refusal::Reason::kRigidGraph);
}

}  // namespace
}  // namespace corda::sim
