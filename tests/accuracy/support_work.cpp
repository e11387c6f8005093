// The work of pins that move against the change of the energy, and what drag takes.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/support_work.hpp"

namespace corda::sim {
namespace {

System system_of(const RopeDef& rope) {
    return build_system({&rope, 1});
}

RopeDef moved(RopeDef rope, const MoveDef& move) {
    rope.moves = {move};
    return rope;
}

// Those of R12 to R14.
RopeDef kapitza_rope() {
    return moved(reference::straight_rope(1, 1.0, 170.0), {0, {{{0.0, 0.1}, 10.0, 90.0}}, {}});
}
RopeDef sideways_rope() {
    return moved(reference::straight_rope(1, 1.0, 0.0), {0, {{{0.2, 0.0}, 0.5, 90.0}}, {}});
}
RopeDef crane_rope() {
    return moved(reference::straight_rope(10, 1.0, 0.0), {0, {}, {{0.0, {}}, {1.0, {1.0, 0.0}}}});
}

/// A driven body, and a bound of the error of its work.
struct Worked {
    System system;
    MethodDef method;
    double bound_j;
};

TEST(MovingPin, DoesTheWorkThatTheEnergyGains) {
    RopeDef bungee = reference::slack_rope(6);
    bungee.material.compliance_1_n = 1e-3;
    bungee.bending_n_m2 = 0.1;
    bungee.moves = {{0, {{{0.1, 0.05}, 1.3, 20.0}}, {}}, {6, {}, {{0.2, {}}, {0.9, {0.2, 0.1}}}}};
    const System crane = system_of(crane_rope());
    const System stretching = system_of(bungee);
    for (const auto& [system, method, bound_j] :
         {Worked{system_of(kapitza_rope()), ExactDef{1e-12}, 1e-8},    // 1.2e-9
          Worked{system_of(sideways_rope()), ExactDef{1e-12}, 1e-12},  // 6.0e-15
          Worked{crane, ExactDef{1e-12}, 1e-10},                       // 1.2e-12
          Worked{crane, RattleDef{8, 1.0 / 400.0}, 1e-10},             // 2.5e-13
          Worked{stretching, ExactDef{1e-12}, 1e-8},                   // 6.9e-10
          Worked{stretching, RattleDef{6, 1e-3}, 1e-8}}) {             // 7.0e-10
        Simulation run(system, WorldDef{}, method);
        SupportWork work(system, WorldDef{}, {&method, 1}, 1.0 / 60.0);
        for (const double t : {0.5, 1.0, 2.0}) {
            ASSERT_EQ(run.advance_to(t), Status::kOk);
            const double gained_j = run.figures().energy_change_j;
            EXPECT_GT(std::abs(gained_j), 1e-5);
            std::printf("work at %g s by %s: %.1e of %.3g J\n", t, method_text(method).c_str(),
                        work.until_j(t) - gained_j, gained_j);
            EXPECT_NEAR(work.until_j(t), gained_j, bound_j);
        }
    }
}

TEST(MovingPin, DoesWorkUntilItIsLetGo) {
    // On its own mass too, whose energy counts from the start.
    RopeDef released = crane_rope();
    released.releases = {{0, 0.7}};
    RopeDef cut = crane_rope();
    cut.cuts = {{4, 0.4}};
    for (const RopeDef& rope : {released, cut}) {
        for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(RattleDef{8, 1.0 / 400.0})}) {
            Simulation run(system_of(rope), WorldDef{}, method);
            SupportWork work(system_of(rope), WorldDef{}, {&method, 1}, 1.0 / 60.0);
            for (const double t : {0.3, 0.7, 1.5}) {
                ASSERT_EQ(run.advance_to(t), Status::kOk);
                EXPECT_NEAR(work.until_j(t), run.figures().energy_change_j, 2e-7) << t;  // 4.8e-8, of rattle
            }
        }
    }
}

TEST(MovingPin, DoesTheWorkThatTheAirTakes) {
    // Drag c takes 2 c times the kinetic energy per second.
    WorldDef world;
    world.drag_1_s = 0.7;
    const System system = system_of(sideways_rope());
    const MethodDef method = ExactDef{1e-12};
    Simulation run(system, world, method);
    run.set_outputs({.velocities = true});
    SupportWork work(system, world, {&method, 1}, 1.0 / 60.0);
    double lost_j = 0.0;
    constexpr int kParts = 2000;
    for (int k = 0; k <= kParts; ++k) {  // Simpson's rule
        ASSERT_EQ(run.advance_to(3.0 * k / kParts), Status::kOk);
        const double kinetic_j = 0.5 * dot({run.state().vx_m_s[1], run.state().vy_m_s[1]},
                                           {run.state().vx_m_s[1], run.state().vy_m_s[1]});
        lost_j += (k == 0 || k == kParts ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * 2.0 * world.drag_1_s * kinetic_j;
    }
    lost_j *= 3.0 / kParts / 3.0;
    EXPECT_GT(lost_j, 0.1);
    EXPECT_NEAR(work.until_j(3.0), run.figures().energy_change_j + lost_j, 1e-9);
}

TEST(MovingPin, DoesUnknownWorkIfForcesAreUnknown) {
    RopeDef rope = sideways_rope();
    const MethodDef relaxation = RelaxationDef{1e-3, 8};
    const System system = system_of(rope);
    EXPECT_TRUE(std::isnan(SupportWork(system, WorldDef{}, {&relaxation, 1}, 1.0 / 60.0).until_j(0.5)));
    rope.material.is_string = true;
    const MethodDef exact = ExactDef{};
    const System string = system_of(rope);
    EXPECT_TRUE(std::isnan(SupportWork(string, WorldDef{}, {&exact, 1}, 1.0 / 60.0).until_j(0.5)));
}

}  // namespace
}  // namespace corda::sim
