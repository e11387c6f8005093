// R17 (section 4 of src/corda/sim/README.md): what is let go falls with its centre of mass on a parabola and
// keeps its angular momentum, and one link turns at a constant rate; by every method and every part of
// `exact`.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "support/nets.hpp"
#include "support/slope.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

constexpr double kReleaseSeconds = 0.7;

/// The whole motion of some particles.
struct Whole {
    Vec2 center_m;
    Vec2 velocity_m_s;
    double spin = 0.0;  ///< angular momentum about the centre of mass, kg m^2 / s

    Whole(const System& system, const State& state, std::size_t first, std::size_t end) {
        double mass_kg = 0.0;
        for (std::size_t i = first; i < end; ++i) {
            const double kg = system.mass_kg[i];
            mass_kg += kg;
            center_m = center_m + kg * Vec2{state.x_m[i], state.y_m[i]};
            velocity_m_s = velocity_m_s + kg * Vec2{state.vx_m_s[i], state.vy_m_s[i]};
        }
        center_m = (1.0 / mass_kg) * center_m;
        velocity_m_s = (1.0 / mass_kg) * velocity_m_s;
        for (std::size_t i = first; i < end; ++i) {
            const Vec2 at = Vec2{state.x_m[i], state.y_m[i]} - center_m;
            const Vec2 v = Vec2{state.vx_m_s[i], state.vy_m_s[i]} - velocity_m_s;
            spin += system.mass_kg[i] * dot(left_of(at), v);
        }
    }
};

State state_at(test::SolverRun<>& run, double time_s) {
    EXPECT_TRUE(run.go(time_s));
    return run.state_with_velocities();
}

/// Errors of the centre of mass in m, and of the angular momentum in parts of 1 kg m^2 / s, of particles
/// first <= i < end, from a time on at which nothing holds them.
std::pair<double, double> errors(test::SolverRun<>& run, double from_s, std::size_t first, std::size_t end,
                                 double drag_1_s = 0.0) {
    const Whole start(run.system(), state_at(run, from_s), first, end);
    std::pair<double, double> largest{0.0, 0.0};
    for (const double time_s : {0.2, 0.9, 1.3, 2.5}) {
        const Whole now(run.system(), state_at(run, from_s + time_s), first, end);
        const double decay = std::exp(-drag_1_s * time_s);
        const double drift_s = drag_1_s > 0.0 ? (1.0 - decay) / drag_1_s : time_s;
        const double fall_s2 = drag_1_s > 0.0 ? (time_s - drift_s) / drag_1_s : 0.5 * time_s * time_s;
        const Vec2 apart =
            now.center_m - start.center_m - drift_s * start.velocity_m_s - fall_s2 * Vec2{0.0, -9.81};
        largest.first = std::max(largest.first, length(apart.x, apart.y));
        largest.second = std::max(largest.second, std::abs(now.spin - decay * start.spin));
    }
    return largest;
}

RopeDef released(RopeDef rope) {
    for (const std::uint32_t pin : rope.pinned) rope.releases.push_back({pin, kReleaseSeconds});
    return rope;
}

/// A closed rope of uneven links that hangs from two pins.
RopeDef hung_ring() {
    RopeDef ring = reference::rope_through(
        {{0.0, 0.0}, {0.3, 0.1}, {0.6, 0.0}, {0.7, -0.4}, {0.5, -0.7}, {0.2, -0.6}, {-0.1, -0.3}});
    ring.closed = true;
    ring.pinned = {0, 2};
    ring.velocity_m_s.assign(7, {0.4, 0.0});
    return ring;
}

/// Ropes of all kinds that `exact` moves, all let go at once, by the part of it that moves them.
std::vector<std::pair<const char*, System>> released_bodies() {
    const RopeDef rope = released(reference::straight_rope(3, 1.0, 60.0));
    const NetDef net = test::as_net(rope);
    RopeDef stretching = rope;
    stretching.material.compliance_1_n = 1e-3;
    RopeDef bent = rope;
    bent.bending_n_m2 = 0.3;
    RopeDef string = rope;
    string.material.is_string = true;
    const RopeDef between = released(reference::slack_rope(6));
    const RopeDef ring = released(hung_ring());
    const RopeDef one = released(reference::straight_rope(1, 1.0, 60.0));
    const RopeDef ten = released(reference::straight_rope(10, 1.0, 40.0));
    return {{"one link", build_system({&one, 1})},
            {"3 links", build_system({&rope, 1})},
            {"10 links", build_system({&ten, 1})},
            {"net", build_system({}, {&net, 1})},
            {"stretching", build_system({&stretching, 1})},
            {"bent", build_system({&bent, 1})},
            {"string", build_system({&string, 1})},
            {"between pins", build_system({&between, 1})},
            {"ring", build_system({&ring, 1})}};
}

TEST(ReleasedR17, FallsExactlyByEveryPartOfExact) {
    for (const double drag_1_s : {0.0, 0.4}) {
        WorldDef world;
        world.drag_1_s = drag_1_s;
        for (const auto& [name, system] : released_bodies()) {
            test::SolverRun<> run(system, world, ExactDef{1e-13});
            const auto [center_m, spin] = errors(run, kReleaseSeconds, 0, system.particle_count(), drag_1_s);
            std::printf("%s, drag %g, by exact: centre %.1e m, angular momentum %.1e\n", name, drag_1_s,
                        center_m, spin);
            EXPECT_LT(center_m, 1e-12) << name;
            EXPECT_LT(spin, 1e-12) << name;
        }
    }
}

TEST(ReleasedR17, OneLinkTurnsAtAConstantRate) {
    const RopeDef rope = released(reference::straight_rope(1, 1.0, 60.0));
    for (const auto& [method, bound] :
         {std::pair{MethodDef(ExactDef{1e-13}), 1e-12}, {MethodDef(RattleDef{8, 1.0 / 120.0}), 1e-10}}) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        const auto angle = [&](double time_s) {
            const State state = state_at(run, time_s);
            return std::atan2(state.y_m[1] - state.y_m[0], state.x_m[1] - state.x_m[0]);
        };
        const State start = state_at(run, kReleaseSeconds);
        const Vec2 along{start.x_m[1] - start.x_m[0], start.y_m[1] - start.y_m[0]};
        const double rate_1_s = dot(left_of(along), {start.vx_m_s[1], start.vy_m_s[1]});
        const double first = angle(kReleaseSeconds);
        EXPECT_GT(std::abs(rate_1_s), 1.0);
        for (const double time_s : {0.1, 0.5, 0.9, 2.0}) {
            const double turned = angle(kReleaseSeconds + time_s) - first - rate_1_s * time_s;
            EXPECT_NEAR(std::remainder(turned, 2.0 * M_PI), 0.0, bound) << time_s;
        }
    }
}

TEST(ReleasedR17, FallsByImplicitStepsThatGoOnAsExplicitOnes) {
    const RopeDef rope = released(reference::straight_rope(10, 1.0, 40.0));
    test::SolverRun<> run(rope, WorldDef{}, ExactDef{1e-7, true});
    const auto [center_m, spin] = errors(run, kReleaseSeconds, 0, 11);
    EXPECT_LT(center_m, 1e-12);
    EXPECT_LT(spin, 1e-7);
}

TEST(ReleasedR17, FallsByRattle) {
    for (const auto& [name, system] : released_bodies()) {
        const Body& body = system.bodies.front();
        if (body.material.is_string) continue;
        test::SolverRun<> run(system, WorldDef{}, RattleDef{8, 1.0 / 240.0});
        const auto [center_m, spin] = errors(run, kReleaseSeconds, 0, system.particle_count());
        std::printf("%s by rattle: centre %.1e m, angular momentum %.1e\n", name, center_m, spin);
        EXPECT_LT(center_m, 1e-11) << name;
        EXPECT_LT(spin, 1e-11) << name;
    }
}

TEST(ReleasedR17, FallsByRelaxationAsLateAsItsStepIsLong) {
    const RopeDef rope = released(reference::straight_rope(3, 1.0, 60.0));
    std::vector<std::pair<double, double>> centers;
    for (const double step_s : {1e-3, 0.5e-3, 0.25e-3}) {
        test::SolverRun<> run(rope, WorldDef{}, RelaxationDef{step_s, 64});
        const auto [center_m, spin] = errors(run, kReleaseSeconds, 0, 4);
        std::printf("3 links by relaxation at %g s: centre %.1e m, angular momentum %.1e\n", step_s, center_m,
                    spin);
        centers.emplace_back(step_s, center_m);
        EXPECT_LT(spin, 30.0 * step_s);  // velocities are those of the middle of a step
    }
    EXPECT_LT(centers.front().second, 0.5 * 9.81 * 2.5 * 1.1e-3);
    EXPECT_NEAR(test::slope(centers), 1.0, 0.1);
}

TEST(Cut, LeavesPartsOfWhichTheFreeOneFallsAsR17) {
    RopeDef rope = reference::straight_rope(10, 1.0, 70.0);
    rope.cuts = {{5, kReleaseSeconds}};
    RopeDef string = rope;
    string.material.is_string = true;
    RopeDef stretching = rope;
    stretching.material.compliance_1_n = 1e-3;
    RopeDef bent = rope;
    bent.bending_n_m2 = 0.1;
    for (const RopeDef& one : {rope, string, stretching, bent}) {
        test::SolverRun<> run(one, WorldDef{}, ExactDef{1e-13});
        const auto [center_m, spin] = errors(run, kReleaseSeconds, 6, 11);
        EXPECT_LT(center_m, 1e-12);
        EXPECT_LT(spin, 1e-12);
    }
    test::SolverRun<> run(rope, WorldDef{}, RattleDef{8, 1.0 / 240.0});
    const auto [center_m, spin] = errors(run, kReleaseSeconds, 6, 11);
    EXPECT_LT(center_m, 1e-11);
    EXPECT_LT(spin, 1e-11);
}

TEST(Cut, LeavesALoneParticleThatFallsExactlyInAnyAir) {
    RopeDef rope = reference::straight_rope(2, 1.0, 70.0);
    rope.cuts = {{1, 0.3}};
    WorldDef windy;
    windy.drag_1_s = 0.5;
    windy.wind_m_s = {4.0, 0.0};
    windy.gusts = {{2.0, 0.0}, 0.4, 30.0};
    // A pair that no bar holds together from the same time on.
    for (const WorldDef& world : {WorldDef{}, windy}) {
        test::SolverRun<> run(rope, world, ExactDef{1e-13});
        const State start = state_at(run, 0.3);
        RopeDef pair = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}});
        pair.pinned = {};
        pair.velocity_m_s.assign(2, {start.vx_m_s[2], start.vy_m_s[2]});
        const System system = build_system({&pair, 1});
        const auto other =
            make_solver(system, Forces(world).from(0.3), std::array{MethodDef(ExactDef{1e-13})}, 1.0);
        State state{0.0, system.x_m, system.y_m};
        for (const double time_s : {0.5, 2.0, 9.0}) {
            ASSERT_TRUE(run.go(0.3 + time_s));
            ASSERT_EQ(other->advance_to(time_s, state), Status::kOk);
            EXPECT_NEAR(run.tip_x(), start.x_m[2] + state.x_m[0], 2e-12) << time_s;
            EXPECT_NEAR(run.tip_y(), start.y_m[2] + state.y_m[0], 1e-11) << time_s;
        }
    }
}

}  // namespace
}  // namespace corda::sim
