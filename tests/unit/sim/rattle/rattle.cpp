// Method `rattle`: its grid of steps and its bits, drag, graphs.

#include "corda/sim/rattle/rattle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/basics.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

TEST(Grid, GivesTheSameBitsForAnyRequestedTimes) {
    for (const double drag_1_s : {0.0, 0.3}) {
        WorldDef world;
        world.drag_1_s = drag_1_s;
        const RopeDef rope = reference::straight_rope(20, 1.0, 80.0);
        test::RattleRun direct(rope, world, 4, 1.0 / 240.0);
        test::RattleRun often(rope, world, 4, 1.0 / 240.0);
        ASSERT_TRUE(direct.go(1.51));
        for (const double time_s : {0.0, 0.001, 0.001, 0.35, 0.7, 1.0, 1.0, 1.5, 1.505, 1.51}) {
            ASSERT_TRUE(often.go(time_s));
            (void)often.loads();
        }
        EXPECT_EQ(direct.state().x_m, often.state().x_m);
        EXPECT_EQ(direct.state().y_m, often.state().y_m);
        EXPECT_EQ(direct.solver().energy_j(), often.solver().energy_j());
        EXPECT_EQ(direct.solver().steps(), 362U);
    }
}

TEST(Grid, IsAsAccurateBetweenItsPoints) {
    test::RattleRun fine(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 8, 1.0 / 640.0);
    test::RattleRun coarse(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 8, 1.0 / 333.0);
    ASSERT_TRUE(fine.go(1.0));
    ASSERT_TRUE(coarse.go(1.0 - 0.4 / 333.0));
    ASSERT_TRUE(coarse.go(1.0));
    EXPECT_LT(coarse.tip_error_m({fine.tip_x(), fine.tip_y()}), 1e-12);
    test::RattleRun between(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 8, 1.0 / 330.7);
    ASSERT_TRUE(between.go(1.0));
    EXPECT_LT(between.tip_error_m({fine.tip_x(), fine.tip_y()}), 1e-12);
}

TEST(Step, DividesTheFrameByDefault) {
    test::RattleRun run(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 4);
    const double parts = 1.0 / 60.0 / run.solver().step_s();
    EXPECT_DOUBLE_EQ(parts, std::round(parts));
    EXPECT_GT(parts, 1.0);
    ASSERT_TRUE(run.go(1.0));
    EXPECT_EQ(run.solver().steps(), static_cast<std::uint64_t>(std::lround(60.0 * parts)));
}

TEST(Drag, SlowsAFreeFallExactlyAndKeepsTheOrder) {
    RopeDef rope = reference::straight_rope(4, 1.0, 20.0);
    rope.pinned = {};
    WorldDef world;
    world.drag_1_s = 1.5;
    const auto error_m = [&](int order, double step_s) {
        test::RattleRun run(rope, world, order, step_s);
        EXPECT_TRUE(run.go(1.0));
        const double c = world.drag_1_s;
        const double fallen_m = -9.81 / c * (1.0 - (1.0 - std::exp(-c)) / c);
        return std::abs(run.tip_y() - run.system().y_m.back() - fallen_m);
    };
    EXPECT_NEAR(std::log2(error_m(2, 0.1) / error_m(2, 0.05)), 2.0, 0.1);
    EXPECT_NEAR(std::log2(error_m(4, 0.1) / error_m(4, 0.05)), 4.0, 0.1);
    EXPECT_LT(error_m(8, 0.05), 1e-13);
}

/// A net of squares hanging from its pinned top row: columns x rows particles, 0.1 m apart.
System net(std::uint32_t columns, std::uint32_t rows, bool diagonals) {
    System system;
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
        const double dx = system.x_m[b] - system.x_m[a];
        const double dy = system.y_m[b] - system.y_m[a];
        system.bars.push_back({a, b, 1, std::sqrt(dx * dx + dy * dy)});
    };
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            system.x_m.push_back(0.1 * c + 0.03 * r);
            system.y_m.push_back(-0.1 * r);
            system.mass_kg.push_back(1.0);
            system.inverse_mass_1_kg.push_back(r == 0 ? 0.0 : 1.0);
        }
    }
    system.vx_m_s.assign(system.x_m.size(), 0.0);
    system.vy_m_s.assign(system.x_m.size(), 0.0);
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            const std::uint32_t i = r * columns + c;
            if (c + 1 < columns) join(i, i + 1);
            if (r + 1 < rows) join(i, i + columns);
            if (diagonals && c + 1 < columns && r + 1 < rows) join(i, i + columns + 1);
        }
    }
    Body body;
    body.particle_count = system.x_m.size();
    body.bar_count = body.link_count = system.bars.size();
    body.is_chain = false;
    system.bodies.push_back(body);
    return system;
}

TEST(Graph, MovesAChainAsAChainSolverDoes) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 60.0);
    const System chain = build_system({&rope, 1});
    System shuffled = chain;
    std::swap(shuffled.bars[2], shuffled.bars[7]);
    const MethodDef def = RattleDef{6, 1.0 / 500.0};
    test::SolverRun<Rattle> first(chain, WorldDef{}, def);
    test::SolverRun<Rattle> second(shuffled, WorldDef{}, def);
    ASSERT_TRUE(first.go(1.0) && second.go(1.0));
    const double largest_m = first.distance_m(second.state());
    std::printf("graph against chain: %.1e m\n", largest_m);
    EXPECT_LT(largest_m, 1e-11);
}

TEST(Graph, ANetSwingsWithItsLengthsAndItsEnergy) {
    test::SolverRun<Rattle> run(net(8, 6, false), WorldDef{}, RattleDef{4});
    ASSERT_TRUE(run.go(1.0));
    std::printf("net: strain %.1e, energy %.1e, h %.1e, parts %llu / %llu\n", run.strain(),
                run.energy_error(), run.solver().step_s(),
                static_cast<unsigned long long>(run.solver().parts()),
                static_cast<unsigned long long>(run.solver().steps()));
    EXPECT_LT(run.strain(), 1e-13);
    EXPECT_LT(run.energy_error(), 1e-6);
}

TEST(Graph, AStraightRopeOfManyNeighboursIsRefused) {
    const RattleDef def{4};
    RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    rope.reach = 7;
    const System seven_neighbours = build_system({&rope, 1});
    EXPECT_THROW(Rattle(seven_neighbours, WorldDef{}, def, 1.0 / 60.0), Error);
}

TEST(Compositions, AreSymmetricAndAddUpToOne) {
    for (const auto& [order, stages] : {std::pair{2, 1U}, {4, 5U}, {6, 9U}, {8, 17U}}) {
        const Composition& table = composition(order);
        EXPECT_EQ(table.order, order);
        ASSERT_EQ(table.stages.size(), stages);
        EXPECT_NEAR(std::accumulate(table.stages.begin(), table.stages.end(), 0.0), 1.0, 2e-16);
        for (std::size_t i = 0; i < stages; ++i) EXPECT_EQ(table.stages[i], table.stages[stages - 1 - i]);
        // Conditions of order 4 and, in part, 6 and 8: the odd power sums vanish below the order.
        for (int power = 3; power < order; power += 2) {
            double sum = 0.0;
            for (const double stage : table.stages) sum += std::pow(stage, power);
            EXPECT_NEAR(sum, 0.0, 1e-15) << order << " " << power;
        }
    }
}

TEST(Lines, AreSteppedOverWhereARhombusIsFlatAtAGridPoint) {
    // Without forces the half angle of a rhombus changes uniformly.
    const auto corners = [](double half, double turned) {
        const Vec2 along{std::cos(turned), std::sin(turned)};
        const Vec2 side = std::sin(half) * along;
        const Vec2 top = std::cos(half) * left_of(along);
        return std::vector<Vec2>{-1.0 * top, side, top, -1.0 * side};
    };
    for (const auto& [order, angle] : {std::pair{4, 0.35}, {4, 0.5}, {6, 0.7}, {6, 0.9}, {8, 0.6}}) {
        for (const double turned : {0.0, 0.3, 0.6, 0.9}) {
            const double rate_1_s = -angle / 0.35;
            RopeDef rope = reference::rope_through(corners(angle, turned));
            rope.closed = true;
            rope.pinned = {};
            rope.velocity_m_s.clear();
            for (const Vec2 along : corners(angle + 0.5 * std::numbers::pi, turned))
                rope.velocity_m_s.push_back(rate_1_s * along);
            WorldDef world;
            world.gravity_m_s2 = {};
            test::RattleRun run(rope, world, order, 1.0 / 60.0);
            double largest_m = 0.0;
            for (int k = 1; k <= 120; ++k) {
                ASSERT_TRUE(run.go(k / 60.0));
                const std::vector<Vec2> truth = corners(angle + rate_1_s * k / 60.0, turned);
                for (std::size_t i = 0; i < 4; ++i) {
                    const Vec2 off = Vec2{run.state().x_m[i], run.state().y_m[i]} - truth[i];
                    largest_m = std::max(largest_m, std::hypot(off.x, off.y));
                }
            }
            EXPECT_LT(largest_m, 1e-6) << order << " " << angle << " " << turned;  // 2e-7; 0.02 from a leap
            EXPECT_FALSE(run.solver().has_branched());
        }
    }
}

TEST(Compositions, AreStableUpToTheTablesLimit) {
    // Half the trace of the composed leapfrog's matrix on x'' = -x with step z.
    const auto half_trace = [](const Composition& table, double z) {
        double a = 1.0, b = 0.0, c = 0.0, d = 1.0;
        for (const double stage : table.stages) {
            const double t = stage * z;
            const double m11 = 1.0 - 0.5 * t * t;
            const double m21 = -t + 0.25 * t * t * t;
            const double a1 = m11 * a + t * c, b1 = m11 * b + t * d;
            c = m21 * a + m11 * c;
            d = m21 * b + m11 * d;
            a = a1;
            b = b1;
        }
        return 0.5 * (a + d);
    };
    for (const int order : {2, 4, 6, 8}) {
        const Composition& table = composition(order);
        for (double z = 0.01; z < table.stable_omega_h; z += 0.01)
            EXPECT_LE(std::abs(half_trace(table, z)), 1.0 + 1e-12) << order << " " << z;
        EXPECT_GT(std::abs(half_trace(table, table.stable_omega_h + 0.02)), 1.0) << order;
    }
}

}  // namespace
}  // namespace corda::sim
