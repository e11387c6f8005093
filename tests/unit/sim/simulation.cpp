#include "corda/sim/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "support/failure.hpp"
#include "support/nets.hpp"
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
    const std::uint64_t steps = run.steps();
    for (const double time_s : {2.0, 3.0, 21.0})
        EXPECT_EQ(run.advance_to(time_s), Status::kDiverged) << time_s;
    EXPECT_EQ(run.steps(), steps);
    EXPECT_EQ(run.state().time_s, 2.0);
}

TEST(Simulation, PassesTimesWithTheSameBitsAndWithoutFigures) {
    const RopeDef rope = reference::straight_rope(5, 1.0, 60.0);
    const MethodDef methods[] = {ExactDef{1e-6}, RattleDef{4, 0.01}, with_step(0.01)};
    for (const MethodDef& method : methods) {
        Simulation run = test::simulate(rope, WorldDef{}, method);
        Simulation passing = test::simulate(rope, WorldDef{}, method);
        State at = passing.state();
        for (const double time_s : {0.3, 0.317, 0.318}) ASSERT_EQ(passing.pass(time_s, at), Status::kOk);
        EXPECT_EQ(at.time_s, 0.318);
        EXPECT_GT(passing.steps(), passing.diagnostics().steps);
        EXPECT_NE(at.x_m, run.state().x_m);
        EXPECT_EQ(passing.state().x_m, run.state().x_m);
        EXPECT_EQ(passing.diagnostics().largest.strain, run.diagnostics().largest.strain);
        EXPECT_EQ(test::code_of([&] { static_cast<void>(passing.advance_to(0.3)); }), ExitCode::kUsage);
        ASSERT_EQ(run.advance_to(0.5), Status::kOk);
        ASSERT_EQ(passing.advance_to(0.5), Status::kOk);
        EXPECT_EQ(passing.state().x_m, run.state().x_m);
        EXPECT_EQ(passing.state().y_m, run.state().y_m);
        EXPECT_EQ(passing.diagnostics().largest.energy_error, run.diagnostics().largest.energy_error);
    }
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

TEST(Simulation, ShowsNoEnergyErrorIfSupportsDoWork) {
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {0.5, -0.6}, {1.0, 0.0}});
    rope.pinned = {0, 2};
    rope.moves = {{2, {{{0.1, 0.0}, 1.0, 0.0}}, {}}};
    RopeDef stretching = rope;
    stretching.material.compliance_1_n = 1e-3;
    const std::pair<RopeDef, MethodDef> runs[] = {{rope, ExactDef{}},
                                                  {rope, RattleDef{}},
                                                  {rope, with_step(0.001)},
                                                  {stretching, ExactDef{}},
                                                  {stretching, RattleDef{}}};
    for (const auto& [moved, method] : runs) {
        Simulation run = test::simulate(moved, WorldDef{}, method);
        ASSERT_EQ(run.advance_to(0.5), Status::kOk);
        EXPECT_FALSE(run.diagnostics().largest.energy_error.has_value());
    }
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

/// A run to 1 s of what each part of a method steps.
struct LongRun {
    std::string name;
    System system;
    MethodDef method;

    [[nodiscard]] Simulation start() const { return {system, WorldDef{}, method}; }
};

System system_with(RopeDef rope, const MaterialDef& material, double bending_n_m2 = 0.0) {
    rope.material = material;
    rope.bending_n_m2 = bending_n_m2;
    return build_system({&rope, 1});
}

std::vector<LongRun> long_runs() {
    const RopeDef rope = reference::straight_rope(100, 1.0, 60.0);
    const NetDef net = test::leaning_net(6, 6, 0.1);
    RelaxationDef many_steps = with_step(1e-5);
    RelaxationDef many_sweeps = with_step(1.0);
    many_sweeps.sweeps = 100'000;
    return {{"series", system_with(rope, {}), ExactDef{1e-9}},
            {"chain that bends", system_with(rope, {}, 1e-3), ExactDef{1e-6}},
            {"elastic", system_with(rope, {1e-4, false}), ExactDef{1e-6}},
            {"string", system_with(reference::report_rope(100), {0.0, true}), ExactDef{1e-9}},
            {"rattle of a chain", system_with(rope, {}), RattleDef{4, 1e-3}},
            {"rattle of a graph", build_system({}, {&net, 1}), RattleDef{4, 1e-3}},
            {"relaxation of many steps", system_with(rope, {}), many_steps},
            {"relaxation of many sweeps", system_with(rope, {}), many_sweeps}};
}

TEST(Simulation, ChecksInEveryMethodForCancellation) {
    for (const LongRun& run : long_runs()) {
        std::uint64_t asked = 0;
        Simulation simulation = run.start();
        {
            const CancelScope counting([&asked] { ++asked; });
            ASSERT_EQ(simulation.advance_to(1.0), Status::kOk) << run.name;
        }
        Simulation alone = run.start();
        ASSERT_EQ(alone.advance_to(1.0), Status::kOk) << run.name;
        EXPECT_EQ(alone.state().x_m, simulation.state().x_m) << run.name;
        const auto* relaxation = std::get_if<RelaxationDef>(&run.method);
        // Pieces of sweeps are 100 times as long, and go over bars too.
        const double steps = static_cast<double>(simulation.diagnostics().steps) *
                             (relaxation == nullptr ? 1.0 : relaxation->sweeps / 50.0);
        const double updates = steps * static_cast<double>(run.system.particle_count());
        EXPECT_GE(static_cast<double>(asked), 0.5 * updates / kUpdatesPerCheck) << run.name;
        EXPECT_GE(asked, 5U) << run.name;
    }
}

TEST(Simulation, EndsInEveryMethodIfCancelled) {
    for (const LongRun& run : long_runs()) {
        Simulation simulation = run.start();
        int left = 3;
        try {
            const CancelScope stop([&left] { return --left > 0; });
            static_cast<void>(simulation.advance_to(1.0));
            ADD_FAILURE() << run.name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kInterrupted) << run.name;
        }
        EXPECT_EQ(left, 0) << run.name;
        EXPECT_EQ(simulation.state().time_s, 0.0) << run.name;
        try {
            static_cast<void>(simulation.advance_to(1.0));
            ADD_FAILURE() << run.name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kUsage) << run.name;
        }
    }
}

TEST(Simulation, IsNotMadeOfALargeNetIfCancelled) {
    const NetDef net = test::leaning_net(80, 80, 0.1);
    int left = 2;
    const CancelScope stop([&left] { return --left > 0; });
    EXPECT_THROW(Simulation(build_system({}, {&net, 1}), WorldDef{}, RattleDef{4}, 0.01), Error);
    EXPECT_EQ(left, 0);
}

TEST(Simulation, IsNotMadeOfManyBodiesIfCancelled) {
    const std::vector<RopeDef> ropes(2000, reference::straight_rope(2, 1.0, 30.0));
    int left = 2;
    const CancelScope stop([&left] { return --left > 0; });
    EXPECT_THROW(Simulation(build_system(ropes), WorldDef{}, ExactDef{}, 0.01), Error);
    EXPECT_EQ(left, 0);
}

/// A plumb line of 3 links of 0.5 m and 1 kg each, released or hanging at rest.
RopeDef plumb_line() {
    RopeDef rope = reference::straight_rope(3, 1.5, 0.0);
    rope.velocity_m_s = {{}, {0.5, 0.0}, {1.0, 0.0}, {1.5, 0.0}};
    return rope;
}

TEST(Simulation, GivesVelocitiesAndTensionsOfEveryMethodThatKnowsThem) {
    // It turns as a rod at first: every link carries the weight and the centripetal force of the links below.
    constexpr double kTurn = 1.0;  // 1/s
    RopeDef elastic = plumb_line();
    RopeDef string = plumb_line();
    string.material.is_string = true;
    elastic.rest_m.clear();
    elastic.material.compliance_1_n = 1e-4;
    for (double below_m : {0.5, 1.0, 1.5}) {
        double load_n = 0.0;
        for (double at_m = below_m; at_m <= 1.5; at_m += 0.5) load_n += 9.81 + kTurn * kTurn * at_m;
        elastic.rest_m.push_back(0.5 / (1.0 + 1e-4 * load_n));
    }
    const std::vector<std::pair<RopeDef, MethodDef>> cases{{plumb_line(), ExactDef{}},
                                                           {plumb_line(), RattleDef{}},
                                                           {string, ExactDef{}},
                                                           {elastic, ExactDef{}},
                                                           {elastic, RattleDef{}}};
    for (const auto& [rope, method] : cases) {
        const std::vector<RopeDef> two{rope, rope};
        Simulation run(build_system(two), WorldDef{}, method);
        ASSERT_EQ(run.advance_to(0.0), Status::kOk);
        EXPECT_TRUE(run.state().tension_n.empty());
        run.set_outputs({.velocities = true, .tensions = true});
        const State& state = run.state();
        ASSERT_EQ(state.tension_n.size(), 6U);
        for (const std::size_t i : {0U, 4U}) EXPECT_NEAR(state.vx_m_s[i + 3], 1.5, 1e-9);
        for (const std::size_t first : {0U, 3U}) {
            // 3 . 9.81 + 0.5 + 1 + 1.5, and so on
            EXPECT_NEAR(state.tension_n[first], 32.43, 1e-6) << method_name(method);
            EXPECT_NEAR(state.tension_n[first + 1], 22.12, 1e-6);
            EXPECT_NEAR(state.tension_n[first + 2], 11.31, 1e-6);
        }
        ASSERT_EQ(run.advance_to(0.1), Status::kOk);
        EXPECT_LT(run.state().vx_m_s[3], 1.5);  // 1.48: it rises
        EXPECT_GT(run.state().vy_m_s[3], 0.0);
        EXPECT_EQ(run.state().vx_m_s[4], 0.0);
    }
}

TEST(Simulation, GivesNaNForUnknownTensionsIfAllowed) {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {0.5, -0.5}, {1.0, -1.5}};
    const std::vector<MethodDef> methods{RelaxationDef{}, ExactDef{}};
    Simulation run(build_system(std::vector{rope, rope}), {}, methods);
    StateFields readings{.tensions = true};
    EXPECT_THROW(run.set_outputs(readings), Error);
    readings.unknown_tensions = true;
    run.set_outputs(readings);
    ASSERT_EQ(run.advance_to(0.1), Status::kOk);
    const std::vector<double>& tension_n = run.state().tension_n;
    ASSERT_EQ(tension_n.size(), 4U);
    EXPECT_TRUE(std::isnan(tension_n[0]) && std::isnan(tension_n[1]));
    EXPECT_GT(tension_n[2], tension_n[3]);
    // Who needs them is still refused.
    EXPECT_FALSE(readings.with({.tensions = true}).unknown_tensions);
    EXPECT_TRUE(readings.with({.velocities = true}).unknown_tensions);
}

TEST(Simulation, RefusesTensionsThatItsMethodDoesNotKnow) {
    Simulation run = test::simulate(plumb_line(), WorldDef{}, RelaxationDef{});
    run.set_outputs({.velocities = true});
    EXPECT_NEAR(run.state().vx_m_s[3], 1.5, 1e-12);
    EXPECT_THROW(run.set_outputs({.tensions = true}), Error);
}

TEST(Simulation, RefusesAWorldOutsideOfItsDeclarations) {
    const RopeDef rope = reference::straight_rope(3, 1.0, 20.0);
    const auto check = [&](const WorldDef& world) {
        return test::failure_of([&] { test::simulate(rope, world, ExactDef{}); }).message;
    };
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(check({}), "");
    EXPECT_THAT(check({{0.0, kNaN}}), testing::HasSubstr("gravity_m_s2"));
    for (const double duration_s : {0.0, -1.0, kInfinity, kNaN})
        EXPECT_THAT(check({{}, duration_s}), testing::HasSubstr("duration_s")) << duration_s;
    for (const double drag_1_s : {-1e-3, kInfinity, kNaN})
        EXPECT_THAT(check({{}, 1.0, drag_1_s}), testing::HasSubstr("drag_1_s")) << drag_1_s;
}

}  // namespace
}  // namespace corda
