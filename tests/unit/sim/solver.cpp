#include "corda/sim/solver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "support/failure.hpp"
#include "support/nets.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

/// The state of a system after 2 s.
State after_2_s(const System& system, const std::vector<MethodDef>& methods) {
    Simulation run(system, WorldDef{}, methods);
    EXPECT_EQ(run.advance_to(2.0), Status::kOk);
    return run.state();
}

/// A rope, a string and a ring, which no single method can move.
struct Mixed {
    RopeDef rope = reference::straight_rope(3, 1.0, 60.0);
    RopeDef string = test::string_of({{0.0, 0.0}, {0.6, 0.0}}, {1.0});
    RopeDef ring = test::free_ring(5);
    std::vector<RopeDef> ropes{rope, string, ring};
    System system = build_system(ropes);
    std::vector<MethodDef> methods{ExactDef{1e-7}, ExactDef{}, RattleDef{6, 0.01}};
};

TEST(BodySolvers, MoveEachBodyAsIfItWereAlone) {
    const Mixed mixed;
    const State all = after_2_s(mixed.system, mixed.methods);
    for (std::size_t i = 0; i < 3; ++i) {
        const State alone = after_2_s(build_system({&mixed.ropes[i], 1}), {mixed.methods[i]});
        const std::size_t first = mixed.system.bodies[i].first_particle;
        for (std::size_t k = 0; k < alone.x_m.size(); ++k) {
            EXPECT_EQ(all.x_m[first + k], alone.x_m[k]) << i;
            EXPECT_EQ(all.y_m[first + k], alone.y_m[k]) << i;
        }
    }
}

TEST(BodySolvers, AddUpEnergiesAndSteps) {
    const Mixed mixed;
    State state{0.0, mixed.system.x_m, mixed.system.y_m};
    const auto all = make_solver(mixed.system, WorldDef{}, mixed.methods, 0.01);
    ASSERT_EQ(all->advance_to(1.0, state), Status::kOk);
    double energy_j = 0.0;
    double scale_j = 0.0;
    std::uint64_t steps = 0;
    double tension_n = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const System system = build_system({&mixed.ropes[i], 1});
        State own{0.0, system.x_m, system.y_m};
        const auto alone = make_solver(system, WorldDef{}, {&mixed.methods[i], 1}, 0.01);
        ASSERT_EQ(alone->advance_to(1.0, own), Status::kOk);
        energy_j += alone->energy_j();
        scale_j += alone->energy_scale_j();
        steps += alone->steps();
        tension_n = std::max(tension_n, test::loads_of(system, own, *alone).value().largest_tension_n);
    }
    EXPECT_DOUBLE_EQ(all->energy_j(), energy_j);
    EXPECT_DOUBLE_EQ(all->energy_scale_j(), scale_j);
    EXPECT_EQ(all->steps(), steps);
    EXPECT_EQ(test::loads_of(mixed.system, state, *all).value().largest_tension_n, tension_n);
    EXPECT_FALSE(all->conserves_energy());  // a string snaps
    EXPECT_EQ(all->methods(), mixed.methods);
}

TEST(BodySolvers, KnowNoTensionsIfABodyKnowsNone) {
    const RopeDef ropes[] = {reference::straight_rope(3, 1.0, 60.0), reference::straight_rope(3, 1.0, 50.0)};
    const std::vector<MethodDef> methods{ExactDef{}, RelaxationDef{}};
    std::vector<double> tension_n(6);
    EXPECT_FALSE(make_solver(build_system(ropes), WorldDef{}, methods, 0.01)->tensions(tension_n));
}

TEST(BodySolvers, RelaxAllBodiesTogetherWithTheBitsOfEach) {
    const RopeDef ropes[] = {reference::straight_rope(3, 1.0, 60.0), reference::straight_rope(3, 1.0, 50.0)};
    const System system = build_system(ropes);
    const State together = after_2_s(system, {RelaxationDef{}});
    const State alone = after_2_s(build_system({&ropes[1], 1}), {RelaxationDef{}});
    EXPECT_TRUE(std::equal(alone.x_m.begin(), alone.x_m.end(), together.x_m.begin() + 4));
}

TEST(BodySolvers, NameTheBodyThatAMethodRefuses) {
    Mixed mixed;
    mixed.ropes[2].bending_n_m2 = 1.0;
    mixed.system = build_system(mixed.ropes);
    const MethodDef exact = ExactDef{};
    EXPECT_EQ(test::refusal_of(mixed.system, exact), Refusal::Reason::kRigidGraph);
    try {
        static_cast<void>(make_solver(mixed.system, WorldDef{}, {&exact, 1}, 0.01));
        FAIL();
    } catch (const Refusal& refusal) {
        EXPECT_EQ(std::string(refusal.what()).find("rope 2: "), 0U) << refusal.what();
    }
}

TEST(BodySolvers, NeedAMethodPerBodyOrOne) {
    const Mixed mixed;
    const std::vector<MethodDef> two(2, ExactDef{});
    EXPECT_THROW(Simulation(mixed.system, WorldDef{}, two), Error);
    EXPECT_THROW(Simulation(mixed.system, WorldDef{}, std::vector<MethodDef>{}), Error);
}

TEST(StepGrid, FindsTimesOnTheGridDespiteTheirRounding) {
    for (const double step_s : {0.1, 1.0 / 3.0, 1.0 / 60.0, 1e-7}) {
        for (const std::uint64_t step : {0U, 1U, 2U, 7U, 1000U, 123456789U}) {
            const auto steps = static_cast<double>(step);
            for (const double time_s :
                 {step_s * steps, step_s * steps * (1.0 + 1e-15), steps / (1.0 / step_s)}) {
                const GridTime at = locate(time_s, step_s);
                EXPECT_TRUE(at.is_on_grid) << step_s << " " << step;
                EXPECT_EQ(at.step, step);
            }
        }
    }
}

TEST(StepGrid, LocatesTimesBetweenSteps) {
    const GridTime at = locate(0.523, 0.1);
    EXPECT_FALSE(at.is_on_grid);
    EXPECT_EQ(at.step, 5U);
    EXPECT_NEAR(at.fraction, 0.23, 1e-14);
    EXPECT_FALSE(locate(0.1 * (1.0 + 2e-9), 0.1).is_on_grid);
    EXPECT_TRUE(locate(0.1 * (1.0 + 0.5e-9), 0.1).is_on_grid);
    EXPECT_EQ(locate(0.1 * (1.0 - 2e-9), 0.1).step, 0U);
    // After a million periods of a pendulum, a tenth of a step is not rounding.
    EXPECT_NEAR(locate(2.4e6 + 0.1 / 60.0, 1.0 / 60.0).fraction, 0.1, 1e-6);
    EXPECT_TRUE(locate(144000001 / 60.0, 1.0 / 60.0).is_on_grid);
}

TEST(Methods, DescribeThemselvesAndTheirSteps) {
    const MethodDef stepped = RattleDef{.order = 6, .step_s = 0.01};
    EXPECT_EQ(method_text(stepped), "rattle of order 6, step 0.01 s");
    EXPECT_EQ(method_text(RelaxationDef{}), "relaxation with 1 sweep");
    EXPECT_EQ(method_text(ExactDef{1e-7}), "exact at tolerance 1e-07");
    EXPECT_EQ(fixed_step_s(stepped), 0.01);
    EXPECT_EQ(fixed_step_s(ExactDef{}), std::nullopt);
    EXPECT_TRUE(knows_tensions(stepped));
    EXPECT_FALSE(knows_tensions(RelaxationDef{}));
}

std::string problem_of(const MethodDef& method) {
    return test::failure_of([&] { validate(method); }).message;
}

TEST(ValidateMethod, AcceptsExactlyTheRanges) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(problem_of(ExactDef{ExactDef::kMinTolerance}), "");
    EXPECT_EQ(problem_of(ExactDef{ExactDef::kMaxTolerance}), "");
    for (const double tolerance : {0.9e-15, 1.1e-2, kNaN})
        EXPECT_EQ(problem_of(ExactDef{tolerance}), "exact: tolerance is not within its range") << tolerance;
    for (const int order : RattleDef::kOrders) EXPECT_EQ(problem_of(RattleDef{order}), "") << order;
    for (const int order : {0, 3, 10}) EXPECT_THAT(problem_of(RattleDef{order}), testing::HasSubstr("order"));
    EXPECT_THAT(problem_of(RattleDef{4, 0.0}), testing::HasSubstr("step_s"));
    EXPECT_EQ(problem_of(RelaxationDef{}), "");
    EXPECT_THAT(problem_of(RelaxationDef{-1.0}), testing::HasSubstr("step_s"));
    EXPECT_THAT(problem_of(RelaxationDef{.sweeps = 0}), testing::HasSubstr("sweeps"));
    EXPECT_THAT(problem_of(RelaxationDef{.delta = 1.0}), testing::HasSubstr("delta"));
    EXPECT_THAT(problem_of(RelaxationDef{.force_n = Vec2{kNaN, 0.0}}), testing::HasSubstr("force_n"));
}

TEST(ImplicitSteps, PayForLongRopesThatHangFromOnePin) {
    const auto pays = [](const RopeDef& rope, double tolerance) {
        const System system = build_system({&rope, 1});
        return implicit_steps_1_s(system, system.bodies[0], WorldDef{}, tolerance) <
               most_implicit_steps_1_s(system, system.bodies[0], WorldDef{});
    };
    EXPECT_TRUE(pays(reference::straight_rope(400, 1.0, 30.0), 1e-4));
    EXPECT_FALSE(pays(reference::straight_rope(400, 1.0, 30.0), 1e-9));
    EXPECT_FALSE(pays(reference::straight_rope(4, 1.0, 30.0), 1e-4));
    EXPECT_FALSE(pays(reference::straight_rope(400, 1.0, 150.0), 1e-4));  // links that rise
    RopeDef elastic = reference::straight_rope(400, 1.0, 30.0);
    elastic.material.compliance_1_n = 1e-6;
    EXPECT_TRUE(pays(elastic, 1e-4));
    elastic.material.compliance_1_n = 1e-4;  // soft
    EXPECT_FALSE(pays(elastic, 1e-4));
}

}  // namespace
}  // namespace corda::sim
