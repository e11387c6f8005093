// Method auto on bodies that are no chains: closed ropes and nets. The truth to hold its estimates against is
// the highest order of `rattle` at a far smaller step than any that it tries.

#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"
#include "support/nets.hpp"
#include "support/plan_of.hpp"

namespace corda::sim {
namespace {

const FrameRate kGraphFrames(Rational{60, 1});

MethodDef fine_rattle(double step_s) {
    return RattleDef{8, step_s};
}

/// Largest distance between two runs at the frame times, in m.
double largest_error_m(const System& system, const MethodDef& solver, const MethodDef& truth, int frames) {
    Simulation run(system, WorldDef{}, solver, kGraphFrames.interval_s());
    Simulation reference(system, WorldDef{}, truth, kGraphFrames.interval_s());
    double largest_m = 0.0;
    for (int k = 0; k <= frames; ++k) {
        EXPECT_EQ(run.advance_to(kGraphFrames.time_s(k)), Status::kOk);
        EXPECT_EQ(reference.advance_to(kGraphFrames.time_s(k)), Status::kOk);
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            largest_m = std::max(largest_m, std::hypot(run.state().x_m[i] - reference.state().x_m[i],
                                                       run.state().y_m[i] - reference.state().y_m[i]));
        }
    }
    return largest_m;
}

template <class Def>
void expect_true_estimate(const System& system, double tolerance_m, int frames) {
    const BodyPlan plan = test::plan_of(system, WorldDef{}, tolerance_m, kGraphFrames, frames);
    ASSERT_TRUE(std::holds_alternative<Def>(plan.method));
    ASSERT_FALSE(plan.horizon_s.has_value());
    ASSERT_TRUE(plan.error_estimate_m.has_value());
    EXPECT_LE(*plan.error_estimate_m, tolerance_m);
    const double step_s = sim::fixed_step_s(plan.method).value_or(1.0 / 250.0) / 8.0;
    const double error_m = largest_error_m(system, plan.method, fine_rattle(step_s), frames);
    // Measured: 0.33 of the estimate, three times the difference that was seen.
    EXPECT_LE(error_m, *plan.error_estimate_m);
    EXPECT_GT(error_m, 0.0);
}

TEST(AutoGraph, EstimateIsTrueForAClosedRope) {
    const RopeDef pinned = test::ring(12);
    const RopeDef free = test::free_ring(12);
    for (const double tolerance_m : {1e-2, 1e-4, 1e-7}) {
        expect_true_estimate<ExactDef>(build_system({&pinned, 1}), tolerance_m, 60);
        expect_true_estimate<ExactDef>(build_system({&free, 1}), tolerance_m, 60);
    }
}

TEST(AutoGraph, EstimateIsTrueForANet) {
    const NetDef net = test::leaning_net(6, 5, 0.2);
    const System system = build_system({}, {&net, 1});
    for (const double tolerance_m : {1e-2, 1e-5}) expect_true_estimate<ExactDef>(system, tolerance_m, 60);
}

TEST(ClosedRope, KeepsItsLengthsItsEnergyAndItsMirrorImage) {
    const RopeDef rope = test::ring(12);
    const System system = build_system({&rope, 1});
    EXPECT_EQ(system.bars.size(), 12U);
    Simulation run(system, WorldDef{}, fine_rattle(1e-3), kGraphFrames.interval_s());
    ASSERT_EQ(run.advance_to(1.0), Status::kOk);
    // Before the ring collapses on itself. Measured: strain 4e-16, energy 7e-16, mirror 3e-14.
    EXPECT_LT(run.diagnostics().largest.strain, 1e-14);
    EXPECT_LT(run.diagnostics().largest.energy_error.value_or(1.0), 1e-12);
    const State& state = run.state();
    for (std::size_t i = 1; i < 12; ++i) {
        EXPECT_NEAR(state.x_m[i], -state.x_m[12 - i], 1e-12);
        EXPECT_NEAR(state.y_m[i], state.y_m[12 - i], 1e-12);
    }
}

}  // namespace
}  // namespace corda::sim
