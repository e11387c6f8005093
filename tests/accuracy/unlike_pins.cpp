// Rigid ropes between pins that move differently (section 9 of src/corda/sim/exact/README.md), by every part
// of `exact` against separate truth.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "support/extended_motion.hpp"
#include "support/slope.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

struct Held {
    const char* name = "";
    RopeDef rope = {};
    WorldDef world = {};
};

std::vector<Held> held_ropes() {
    const std::vector<Vec2> arch{{0.0, 0.0},  {0.1, -0.3}, {0.3, -0.5}, {0.6, -0.6},
                                 {0.9, -0.5}, {1.1, -0.3}, {1.2, 0.0}};
    const std::vector<WaveDef> wave{{{0.1, 0.05}, 1.3, 20.0}};
    const std::vector<PathKeyDef> path{{0.2, {}}, {0.9, {-0.3, 0.1}}, {1.7, {0.1, 0.0}}};
    std::vector<Held> all(4);
    all[0] = {"two pins", reference::rope_through(arch), {}};
    all[0].rope.pinned = {0, 6};
    all[0].rope.moves = {{0, wave, {}}, {6, {}, path}};
    all[1] = all[0];
    all[1].name = "two pins in wind";
    all[1].world.drag_1_s = 0.5;
    all[1].world.wind_m_s = {4.0, 0.0};
    all[1].world.gusts = {{2.0, 0.0}, 0.4, 0.0};
    all[2] = all[0];
    all[2].name = "a pin at rest, one that moves, and free ends";
    all[2].rope.pinned = {1, 4};
    all[2].rope.moves = {{4, {{{0.06, 0.05}, 1.3, 20.0}}, {{0.2, {}}, {0.9, {-0.2, 0.1}}}}};
    all[3] = all[0];
    all[3].name = "a closed rope";
    all[3].rope.closed = true;
    all[3].rope.pinned = {0, 3};
    all[3].rope.moves = {{3, wave, {}}, {0, {}, {{0.2, {}}, {0.9, {0.2, -0.1}}}}};
    return all;
}

constexpr double kTimesS[] = {0.15, 0.5, 0.9, 1.3, 1.9};

/// The largest distance of a particle from the truth.
double error_m(Solver& solver, const System& system, const WorldDef& world) {
    test::ExtendedMotion truth(system, world);
    State state{0.0, system.x_m, system.y_m};
    double largest_m = 0.0;
    for (const double t : kTimesS) {
        if (solver.advance_to(t, state) != Status::kOk || !truth.advance_to(t)) return HUGE_VAL;
        for (std::size_t i = 0; i < system.particle_count(); ++i)
            largest_m = std::max(largest_m, std::hypot(state.x_m[i] - static_cast<double>(truth.x_m(i)),
                                                       state.y_m[i] - static_cast<double>(truth.y_m(i))));
    }
    return largest_m;
}

TEST(PinsThatMoveDifferently, AreExactByEveryPartOfExact) {
    for (const Held& held : held_ropes()) {
        const System system = build_system({&held.rope, 1});
        const auto error_of = [&](const MethodDef& method) {
            return error_m(*make_solver(system, held.world, {&method, 1}, 1.0 / 60.0), system, held.world);
        };
        OdePart by_dop853(system, held.world,
                          std::make_unique<ChainDynamics>(system, system.bodies, held.world), 1e-13);
        const double series_m = error_of(ExactDef{1e-13});
        const double dop853_m = error_m(by_dop853, system, held.world);
        const double implicit_m = error_of(ExactDef{1e-9, true});
        const double rattle_m = error_of(RattleDef{8, 1.0 / 480.0});
        std::printf("%s: series %.1e m, DOP853 %.1e m, implicit %.1e m, rattle 8 %.1e m\n", held.name,
                    series_m, dop853_m, implicit_m, rattle_m);
        EXPECT_LT(series_m, 1e-13) << held.name;    // 6.6e-15
        EXPECT_LT(dop853_m, 2e-13) << held.name;    // 1.6e-14
        EXPECT_LT(implicit_m, 3e-10) << held.name;  // 3.4e-11
    }
}

TEST(PinsThatMoveDifferently, HaveTheVelocitiesTensionsAndLoadsOfRattle) {
    for (const Held& held : held_ropes()) {
        for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(ExactDef{1e-12, true})}) {
            test::SolverRun<> exact(held.rope, held.world, method);
            test::SolverRun<> other(held.rope, held.world, RattleDef{8, 1.0 / 480.0});
            const bool is_implicit = std::get<ExactDef>(method).implicit;
            for (const double t : kTimesS) {
                ASSERT_TRUE(exact.go(t) && other.go(t));
                const State a = exact.state_with_velocities();
                const State b = other.state_with_velocities();
                for (std::size_t i = 0; i < a.x_m.size(); ++i) {
                    EXPECT_NEAR(a.vx_m_s[i], b.vx_m_s[i], is_implicit ? 1e-5 : 1e-7) << held.name << ' ' << t;
                    EXPECT_NEAR(a.vy_m_s[i], b.vy_m_s[i], is_implicit ? 1e-5 : 1e-7) << held.name << ' ' << t;
                }
                EXPECT_NEAR(exact.loads()->pin_force_n, other.loads()->pin_force_n, is_implicit ? 1e-3 : 1e-5)
                    << held.name << ' ' << t;
                EXPECT_NEAR(exact.solver().energy_j(), other.solver().energy_j(), is_implicit ? 1e-4 : 1e-6)
                    << held.name << ' ' << t;
            }
        }
    }
}

TEST(PinsThatMoveDifferently, EndARunWhereTheyAreFartherApartThanTheRopeIsLong) {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {0.5, -0.5}, {1.0, 0.0}});
    rope.pinned = {0, 2};
    rope.moves = {{2, {}, {{0.0, {}}, {1.0, {1.0, 0.0}}}}};
    for (const MethodDef& method : {MethodDef(ExactDef{1e-9}), MethodDef(ExactDef{1e-9, true})}) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        EXPECT_TRUE(run.go(0.3));
        EXPECT_FALSE(run.go(1.0));
        EXPECT_LT(run.solver().steps(), 2000U);
    }
    const System system = build_system({&rope, 1});
    OdePart by_dop853(system, WorldDef{}, std::make_unique<ChainDynamics>(system, system.bodies, WorldDef{}),
                      1e-9);
    State state{0.0, system.x_m, system.y_m};
    EXPECT_EQ(by_dop853.advance_to(1.0, state), Status::kDiverged);
    EXPECT_LT(by_dop853.steps(), 2000U);
}

}  // namespace
}  // namespace corda::sim
