#include "corda/sim/relaxation/relaxation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "support/random_system.hpp"
#include "support/simulate.hpp"

namespace corda::sim {
namespace {

/// Two free unit masses without gravity, 2 m apart, the right one moving right at 1 m/s.
RopeDef moving_pair() {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {2.0, 0.0}});
    rope.velocity_m_s[1] = {1.0, 0.0};
    rope.pinned = {};
    return rope;
}

RelaxationDef with_step(double step_s) {
    RelaxationDef def;
    def.step_s = step_s;
    return def;
}

const WorldDef kWeightless{{0.0, 0.0}, 10.0, 0.0};

TEST(RelaxationOfABar, MovesTwoFreeParticlesByHalfEach) {
    // Euler step of 0.5 s: the right one is at 2.5, the bar 0.5 too long; each end moves by 0.25.
    Simulation run = test::simulate(moving_pair(), kWeightless, with_step(0.5));
    ASSERT_EQ(run.advance_to(0.5), Status::kOk);
    EXPECT_EQ(run.state().x_m[0], 0.25);
    EXPECT_EQ(run.state().x_m[1], 2.25);
}

TEST(RelaxationOfABar, MovesAFreeParticleBesideAPinnedOneByTheWhole) {
    RopeDef rope = moving_pair();
    rope.pinned = {0};
    Simulation run = test::simulate(rope, kWeightless, with_step(0.5));
    ASSERT_EQ(run.advance_to(0.5), Status::kOk);
    EXPECT_EQ(run.state().x_m[0], 0.0);
    EXPECT_EQ(run.state().x_m[1], 2.0);
}

TEST(RelaxationOfABar, LeavesTwoPinnedParticlesAlone) {
    RopeDef rope = moving_pair();
    rope.pinned = {0, 1};
    Simulation run = test::simulate(rope, WorldDef{}, with_step(0.5));
    ASSERT_EQ(run.advance_to(1.0), Status::kOk);
    EXPECT_EQ(run.state().x_m[1], 2.0);
    EXPECT_EQ(run.state().y_m[1], 0.0);
}

TEST(RelaxationOfABar, IgnoresTheMassesAsTheReportDoes) {
    RopeDef rope = moving_pair();
    rope.mass_kg = {1.0, 1000.0};
    Simulation run = test::simulate(rope, kWeightless, with_step(0.5));
    ASSERT_EQ(run.advance_to(0.5), Status::kOk);
    EXPECT_EQ(run.state().x_m[0], 0.25);
    EXPECT_EQ(run.state().x_m[1], 2.25);
}

TEST(RelaxationOfABar, SurvivesAZeroLengthMetAtRunTime) {
    // The right particle flies exactly onto the left one in one step.
    RopeDef rope = moving_pair();
    rope.velocity_m_s = {{0.0, 0.0}, {-2.0, 0.0}};
    rope.pinned = {0};
    Simulation run = test::simulate(rope, kWeightless, with_step(1.0));
    ASSERT_EQ(run.advance_to(1.0), Status::kOk);
    EXPECT_EQ(run.state().x_m[1], 0.0);
    ASSERT_EQ(run.advance_to(2.0), Status::kOk);
    EXPECT_EQ(run.state().x_m[1], -2.0);
}

TEST(VerletUpdate, MatchesAHandCalculation) {
    // One free particle of mass 2 falls beside its pin with a bar too slack to act: reach 1, and the bar's
    // length is restored only along x, which a fall from straight below the pin never leaves. h = 1/2, delta
    // = 1/4, f = (0, -8): push = (1/4 / 2)(-8) = -1. Euler start without velocity: y1 = y0. Then the bar
    // pulls it back to -1 every step.
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {0.0, 4.0}};
    rope.mass_kg = {1.0, 2.0};
    rope.velocity_m_s = {{}, {}};
    rope.pinned = {};
    RelaxationDef solver = with_step(0.5);
    solver.delta = 0.25;
    solver.force_n = Vec2{0.0, -8.0};
    Simulation run = test::simulate(rope, WorldDef{}, solver);
    ASSERT_EQ(run.advance_to(0.5), Status::kOk);
    EXPECT_EQ(run.state().y_m[0], 0.0);
    EXPECT_EQ(run.state().y_m[1], 4.0);
    // Step 2: pushes (h^2 / m) f: -2 for mass 1, -1 for mass 2: y = -2 and 3, the bar 5 long: each moves by
    // 1/2.
    ASSERT_EQ(run.advance_to(1.0), Status::kOk);
    EXPECT_EQ(run.state().y_m[0], -1.5);
    EXPECT_EQ(run.state().y_m[1], 2.5);
    // Step 3: 3/4 of the last moves (-1.5 and -1.5) and the pushes: -4.625 and 0.375, the bar 5 long again.
    ASSERT_EQ(run.advance_to(1.5), Status::kOk);
    EXPECT_EQ(run.state().y_m[0], -4.125);
    EXPECT_EQ(run.state().y_m[1], -0.125);
}

TEST(RelaxationTimes, BetweenTwoStepsLieOnTheParabola) {
    // A free particle falls on a parabola: interpolation has to give it back. The bar to its companion keeps
    // its length.
    RopeDef rope = moving_pair();
    rope.velocity_m_s = {{1.0, 2.0}, {1.0, 2.0}};
    Simulation run = test::simulate(rope, WorldDef{{0.0, -10.0}, 10.0, 0.0}, with_step(0.1));
    ASSERT_EQ(run.advance_to(0.523), Status::kOk);
    // x_n = x_0 + n h v + h^2 a n (n - 1) / 2 at n = t / h.
    const double n = 5.23;
    EXPECT_NEAR(run.state().x_m[0], n * 0.1, 1e-14);                              // measured 0
    EXPECT_NEAR(run.state().y_m[0], n * 0.2 - 0.1 * n * (n - 1.0) / 2.0, 1e-14);  // measured 2e-16
}

TEST(RelaxationTimes, DoNotDependOnEarlierRequestedTimes) {
    RelaxationDef solver = with_step(0.003);
    Simulation straight = test::simulate(test::report_rope(20), WorldDef{}, solver);
    Simulation stopping = test::simulate(test::report_rope(20), WorldDef{}, solver);
    ASSERT_EQ(straight.advance_to(2.0), Status::kOk);
    for (int k = 0; k <= 48; ++k) ASSERT_EQ(stopping.advance_to(2.0 * k / 48.0), Status::kOk);
    EXPECT_EQ(straight.state().x_m, stopping.state().x_m);
    EXPECT_EQ(straight.state().y_m, stopping.state().y_m);
}

TEST(Relaxation, GivesTheSameBitsOnEveryRunAndFarFromTheOrigin) {
    RopeDef far = test::report_rope(40);
    far.origin_m = {1e6, 1e6};
    Simulation a = test::simulate(test::report_rope(40), WorldDef{}, RelaxationDef{});
    Simulation b = test::simulate(far, WorldDef{}, RelaxationDef{});
    ASSERT_EQ(a.advance_to(10.0), Status::kOk);
    ASSERT_EQ(b.advance_to(10.0), Status::kOk);
    EXPECT_EQ(a.state().x_m, b.state().x_m);
    EXPECT_EQ(a.state().y_m, b.state().y_m);
}

TEST(Relaxation, DragIsDampingAtItsExactRate) {
    // A free particle without a force: 1 - delta = exp(-c h) makes its velocity decay by exp(-c t).
    RopeDef rope = moving_pair();
    rope.velocity_m_s = {{1.0, 0.0}, {1.0, 0.0}};
    Simulation run = test::simulate(rope, WorldDef{{0.0, 0.0}, 10.0, 0.7}, with_step(0.01));
    ASSERT_EQ(run.advance_to(2.0), Status::kOk);
    const double before_m = run.state().x_m[0];
    ASSERT_EQ(run.advance_to(2.01), Status::kOk);
    EXPECT_NEAR((run.state().x_m[0] - before_m) / 0.01, std::exp(-0.7 * 2.0), 1e-12);  // measured 2e-14
}

}  // namespace
}  // namespace corda::sim
