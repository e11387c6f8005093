#include "corda/sim/simulation.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "corda/core/basics.hpp"
#include "support/random_system.hpp"
#include "support/simulate.hpp"

namespace corda {
namespace {

RelaxationDef with_step(double step_s) {
    RelaxationDef def;
    def.step_s = step_s;
    return def;
}

/// A rope that is farther away than a state may be between 2 s and 20 s.
Simulation flying_away() {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {2.0, 0.0}});
    rope.pinned = {};
    RelaxationDef solver = with_step(1.0);
    solver.force_n = Vec2{1e11, 0.0};
    return test::simulate(rope, WorldDef{}, solver);
}

TEST(Simulation, ReportsDivergenceAndKeepsTheLastGoodState) {
    Simulation run = flying_away();
    ASSERT_EQ(run.advance_to(2.0), Status::kOk);
    const std::vector<double> good = run.state().x_m;
    EXPECT_EQ(run.advance_to(20.0), Status::kDiverged);
    EXPECT_EQ(run.state().x_m, good);
    EXPECT_EQ(run.state().time_s, 2.0);
}

TEST(Simulation, StaysWhereItDiverged) {
    Simulation run = flying_away();
    ASSERT_EQ(run.advance_to(2.0), Status::kOk);
    ASSERT_EQ(run.advance_to(20.0), Status::kDiverged);
    const std::uint64_t steps = run.diagnostics().steps;
    for (const double time_s : {2.0, 3.0, 21.0})
        EXPECT_EQ(run.advance_to(time_s), Status::kDiverged) << time_s;
    EXPECT_EQ(run.diagnostics().steps, steps);
    EXPECT_EQ(run.state().time_s, 2.0);
}

TEST(Simulation, ShowsNoEnergyErrorIfDampingTakesEnergy) {
    RelaxationDef solver = with_step(0.01);
    Simulation undamped = test::simulate(test::report_rope(10), WorldDef{}, solver);
    ASSERT_EQ(undamped.advance_to(1.0), Status::kOk);
    ASSERT_TRUE(undamped.diagnostics().largest.energy_error.has_value());
    EXPECT_GT(*undamped.diagnostics().largest.energy_error, 0.0);
    EXPECT_LT(*undamped.diagnostics().largest.energy_error, 1e-3);
    EXPECT_EQ(undamped.diagnostics().steps, 100U);
    solver.delta = 0.01;
    Simulation damped = test::simulate(test::report_rope(10), WorldDef{}, solver);
    ASSERT_EQ(damped.advance_to(1.0), Status::kOk);
    EXPECT_FALSE(damped.diagnostics().largest.energy_error.has_value());
}

TEST(Simulation, RefusesTimesThatItCannotReach) {
    Simulation run = test::simulate(test::report_rope(10), WorldDef{}, with_step(0.01));
    ASSERT_EQ(run.advance_to(1.0), Status::kOk);
    const double infinite = std::numeric_limits<double>::infinity();
    for (const double time_s : {0.5, -1.0, infinite, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(static_cast<void>(run.advance_to(time_s)), Error) << time_s;
    EXPECT_EQ(run.state().time_s, 1.0);
    EXPECT_EQ(run.advance_to(1.0), Status::kOk);
}

}  // namespace
}  // namespace corda
