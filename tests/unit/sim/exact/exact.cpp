#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "support/nets.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using Reason = Refusal::Reason;

TEST(ExactRefuses, BarsBetweenParticlesThatAreNotNeighbours) {
    RopeDef rope = reference::straight_rope(10, 1.0, 45.0);
    rope.reach = 7;
    EXPECT_EQ(test::refusal_of(build_system({&rope, 1}), ExactDef{}), Reason::kImaginaryBars);
}

TEST(ExactRefuses, ARopeTautBetweenTwoPins) {
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.pinned = {0, 10};
    EXPECT_EQ(test::refusal_of(build_system({&rope, 1}), ExactDef{}), Reason::kTautBetweenPins);
    rope.points_m[5].y -= 1e-3;
    EXPECT_EQ(test::refusal_of(build_system({&rope, 1}), ExactDef{}), std::nullopt);
}

TEST(Exact, DoesNotMoveAFullyPinnedRope) {
    RopeDef rope = reference::straight_rope(2, 1.0, 90.0);
    rope.pinned = {0, 1, 2};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(5.0));
    EXPECT_EQ(run.state().x_m, run.system().x_m);
    EXPECT_EQ(run.state().y_m, run.system().y_m);
}

/// A closed rope of 7 links pinned at `pins`, and the same one cut open at the first of them.
void expect_ring_moves_as_cut(const std::vector<std::uint32_t>& pins, double tolerance, bool implicit) {
    constexpr std::size_t kLinks = 7;
    RopeDef ring = test::ring(static_cast<int>(kLinks));
    ring.mass_kg = {1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.2};
    ring.velocity_m_s[4] = {1.0, 0.3};
    ring.pinned = {pins.begin(), pins.end()};
    RopeDef cut;
    for (std::size_t i = 0; i <= kLinks; ++i) {
        const std::size_t from = (pins.front() + i) % kLinks;
        cut.points_m.push_back(ring.points_m[from]);
        cut.mass_kg.push_back(ring.mass_kg[from]);
        cut.velocity_m_s.push_back(ring.velocity_m_s[from]);
    }
    for (const std::uint32_t pin : pins) cut.pinned.push_back(pin - pins.front());
    cut.pinned.push_back(kLinks);
    const auto run_of = [&](const RopeDef& rope) {
        Simulation run(build_system({&rope, 1}), WorldDef{}, ExactDef{tolerance, implicit});
        run.set_outputs({.velocities = true, .tensions = true});
        EXPECT_EQ(run.advance_to(0.6), Status::kOk);
        return run;
    };
    const Simulation closed = run_of(ring);
    const Simulation open = run_of(cut);
    ASSERT_EQ(closed.state().tension_n.size(), kLinks);
    for (std::size_t i = 0; i < kLinks; ++i) {
        const std::size_t from = (pins.front() + i) % kLinks;
        EXPECT_NEAR(closed.state().x_m[from], open.state().x_m[i], 1e-9) << i;
        EXPECT_NEAR(closed.state().y_m[from], open.state().y_m[i], 1e-9) << i;
        EXPECT_NEAR(closed.state().vx_m_s[from], open.state().vx_m_s[i], 1e-8) << i;
        EXPECT_NEAR(closed.state().tension_n[from], open.state().tension_n[i], 1e-6) << i;
    }
    EXPECT_NEAR(closed.figures().loads->largest_tension_n, open.figures().loads->largest_tension_n, 1e-6);
    EXPECT_LT(closed.diagnostics().largest.strain, 1e-12);
}

TEST(Exact, MovesAClosedRopeOnAPinAsTheRopeCutThere) {
    for (const bool implicit : {false, true}) {
        expect_ring_moves_as_cut({0}, 1e-10, implicit);
        expect_ring_moves_as_cut({3}, 1e-10, implicit);
        expect_ring_moves_as_cut({2, 5}, 1e-10, implicit);
        expect_ring_moves_as_cut({1, 2, 4}, 1e-10, implicit);
    }
}

TEST(ExactRefuses, AClosedRopeThatResistsBending) {
    RopeDef ring = test::ring(7);
    ring.bending_n_m2 = 0.1;
    EXPECT_EQ(test::refusal_of(build_system({&ring, 1}), ExactDef{}), Reason::kRigidGraph);
}

TEST(Exact, MovesBothSidesOfAPinInTheMiddleAlike) {
    RopeDef rope = reference::straight_rope(6, 2.0, 90.0);
    for (Vec2& point : rope.points_m) point.x -= 1.0;
    rope.pinned = {3};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(0.7));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(run.state().x_m[i], -run.state().x_m[6 - i], 1e-12);
        EXPECT_NEAR(run.state().y_m[i], run.state().y_m[6 - i], 1e-12);
    }
    EXPECT_EQ(run.state().x_m[3], 0.0);
    // The same as half of the rope alone; the pin holds both, whose sideways pulls cancel.
    test::ExactRun half(reference::straight_rope(3, 1.0, 90.0));
    ASSERT_TRUE(half.go(0.7));
    EXPECT_NEAR(run.state().x_m[6], half.state().x_m[3], 1e-12);
    EXPECT_NEAR(run.state().y_m[6], half.state().y_m[3], 1e-12);
    EXPECT_NEAR(run.loads().value().largest_tension_n, half.loads().value().largest_tension_n, 1e-9);
    EXPECT_LT(run.loads().value().pin_force_n, 2.0 * half.loads().value().pin_force_n);
}

TEST(Exact, MovesARopePinnedAtItsLastParticleAsItsMirrorImage) {
    RopeDef rope = reference::straight_rope(5, 1.0, 90.0);
    test::ExactRun forwards(rope);
    std::reverse(rope.points_m.begin(), rope.points_m.end());
    rope.pinned = {5};
    test::ExactRun backwards(rope);
    ASSERT_TRUE(forwards.go(1.0) && backwards.go(1.0));
    for (std::size_t i = 0; i <= 5; ++i) {
        EXPECT_EQ(forwards.state().x_m[i], backwards.state().x_m[5 - i]);
        EXPECT_EQ(forwards.state().y_m[i], backwards.state().y_m[5 - i]);
    }
}

TEST(Exact, ThrownFreeRopeKeepsMomentum) {
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.pinned = {};
    rope.mass_kg = {1.0, 2.0, 3.0, 1.0, 5.0, 1.0};
    rope.velocity_m_s[5] = {2.0, 3.0};  // would stretch the rope: impulses share it out
    test::ExactRun run(rope, 1e-9, WorldDef{{0.0, 0.0}, 10.0, 0.0});
    const auto centre_x_m = [&](const std::vector<double>& x_m) {
        double sum = 0.0;
        for (std::size_t i = 0; i < x_m.size(); ++i) sum += rope.mass_kg[i] * x_m[i];
        return sum / 13.0;
    };
    const double start_m = centre_x_m(run.system().x_m);
    ASSERT_TRUE(run.go(10.0));
    EXPECT_NEAR(centre_x_m(run.state().x_m), start_m + 10.0 * 2.0 / 13.0, 1e-9);
    EXPECT_LT(run.energy_error(), 1e-9);
}

TEST(Exact, DragIsExact) {
    // A free particle pair side by side falls as one: v = (g / c) (1 - exp(-c t)).
    RopeDef rope = reference::straight_rope(1, 1.0, 90.0);
    rope.pinned = {};
    const double drag_1_s = 0.7;
    test::ExactRun run(rope, 1e-12, WorldDef{{0.0, -9.81}, 10.0, drag_1_s});
    ASSERT_TRUE(run.go(3.0));
    const double fallen_m = 9.81 / drag_1_s * (3.0 - (1.0 - std::exp(-3.0 * drag_1_s)) / drag_1_s);
    EXPECT_NEAR(run.state().y_m[0], -fallen_m, 1e-11);
    EXPECT_FALSE(run.solver().conserves_energy());
}

TEST(Exact, HangingRopeCarriesItsWeight) {
    RopeDef rope = reference::straight_rope(4, 1.0, 0.0);
    rope.payload_kg = 6.0;
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(1.0));
    const Loads loads = run.loads().value();
    EXPECT_NEAR(loads.pin_force_n, 98.1, 1e-12);
    EXPECT_NEAR(loads.largest_tension_n, 98.1, 1e-12);
    EXPECT_NEAR(run.solver().energy_scale_j(), 98.1, 1e-12);
}

TEST(Exact, WithoutGravityAndMotionStays) {
    RopeDef rope = reference::straight_rope(4, 1.0, 77.0);
    test::ExactRun run(rope, 1e-9, WorldDef{{0.0, 0.0}, 10.0, 0.0});
    ASSERT_TRUE(run.go(10.0));
    EXPECT_LT(run.tip_error_m({rope.points_m.back().x, rope.points_m.back().y}), 1e-15);
}

TEST(Exact, ClosedBetweenTwoPinsKeepsEnergyAndEnds) {
    std::vector<Vec2> points_m;
    for (int i = 0; i <= 10; ++i) points_m.push_back({0.1 * i, i % 2 ? -0.05 : 0.05});
    points_m.front().y = points_m.back().y = 0.0;
    RopeDef rope = reference::rope_through(std::move(points_m));
    rope.pinned = {0, 10};
    test::ExactRun run(rope);
    for (int k = 1; k <= 300; ++k) {
        ASSERT_TRUE(run.go(k / 60.0));
        EXPECT_LT(run.energy_error(), 1e-9);
        EXPECT_LT(run.strain(), 1e-13);
    }
}

/// Two cranks of 1 m on pins `base_m` apart, joined by a bar as long, turning alike at `speed_m_s`.
RopeDef parallelogram(double base_m, double speed_m_s) {
    const Vec2 crank{std::sin(1.0), -std::cos(1.0)};
    RopeDef rope = reference::rope_through({{0.0, 0.0}, crank, crank + Vec2{base_m, 0.0}, {base_m, 0.0}});
    rope.pinned = {0, 3};
    rope.velocity_m_s = {{}, speed_m_s * left_of(crank), speed_m_s * left_of(crank), {}};
    return rope;
}

TEST(Exact, FollowsAParallelogramOverTheLineOfItsBars) {
    for (const double tolerance : {1e-5, 1e-9, 1e-12}) {
        for (int k = 0; k < 40; ++k) {
            const double speed_m_s = 2.0 + 0.25 * k;
            test::ExactRun run(parallelogram(1.0 + 0.05 * k, speed_m_s), tolerance);
            ASSERT_TRUE(run.go(3.0, 180));
            // Measured: 0.3, 0.4 and 0.3 times the tolerance; 0.1 m g L and more if steps start near the
            // line.
            EXPECT_LT(run.energy_error(), 3.0 * tolerance) << speed_m_s;
            EXPECT_NEAR(run.state().y_m[1], run.state().y_m[2], 1e-13);  // measured 6e-15
        }
    }
}

TEST(Exact, DoesNotMoveAHeavyParticleBehindLightOnes) {
    for (const std::size_t heavy : {0U, 1U, 2U}) {
        RopeDef rope = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}, {1.5, 0.5}});
        rope.pinned = {};
        rope.mass_kg.assign(3, 1e-6);
        rope.mass_kg[heavy] = 1e9;
        rope.velocity_m_s.assign(3, {0.0, -5.0});
        rope.velocity_m_s[heavy] = {0.0, 1e-14};  // as much momentum
        WorldDef world;
        world.gravity_m_s2 = {};
        test::ExactRun run(rope, 1e-5, world);
        ASSERT_TRUE(run.go(5.0, 300));
        // Within the recoil of 1e-15 of the light ones, and rounding; 1e-8 if the state held a light
        // particle.
        EXPECT_NEAR(run.state().x_m[heavy], rope.points_m[heavy].x, 2e-14) << heavy;
        EXPECT_NEAR(run.state().y_m[heavy], rope.points_m[heavy].y, 2e-14) << heavy;
    }
}

TEST(Exact, FollowsAHeavyMassThatPullsLightLinksTaut) {
    // The links come into line within 1e-13 s.
    RopeDef rope = reference::straight_rope(4, 1.0, 239.0);
    rope.mass_kg = {1.0, 0.01, 1.0, 1e11, 0.1};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(0.5, 30));
    EXPECT_LT(run.energy_error(), 1e-8);  // measured 3e-10
}

}  // namespace
}  // namespace corda::sim
