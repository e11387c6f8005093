#include "corda/sim/solver.hpp"

#include <gtest/gtest.h>

#include "corda/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/validate.hpp"
#include "support/nets.hpp"
#include "support/refusal_of.hpp"
#include "support/strings.hpp"
#include "support/unstopped.hpp"

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
    RopeDef ring = test::ring(5);
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
    ASSERT_EQ(all->advance_to(1.0, state, test::unstopped), Status::kOk);
    double energy_j = 0.0;
    double scale_j = 0.0;
    std::uint64_t steps = 0;
    double tension_n = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const System system = build_system({&mixed.ropes[i], 1});
        State own{0.0, system.x_m, system.y_m};
        const auto alone = make_solver(system, WorldDef{}, {&mixed.methods[i], 1}, 0.01);
        ASSERT_EQ(alone->advance_to(1.0, own, test::unstopped), Status::kOk);
        energy_j += alone->energy_j();
        scale_j += alone->energy_scale_j();
        steps += alone->steps();
        tension_n = std::max(tension_n, alone->loads().value().largest_tension_n);
    }
    EXPECT_DOUBLE_EQ(all->energy_j(), energy_j);
    EXPECT_DOUBLE_EQ(all->energy_scale_j(), scale_j);
    EXPECT_EQ(all->steps(), steps);
    EXPECT_EQ(all->loads().value().largest_tension_n, tension_n);
    EXPECT_FALSE(all->conserves_energy());  // a string snaps
    EXPECT_EQ(all->methods(), mixed.methods);
}

TEST(BodySolvers, KnowNoLoadsIfABodyKnowsNone) {
    const RopeDef ropes[] = {reference::straight_rope(3, 1.0, 60.0), reference::straight_rope(3, 1.0, 50.0)};
    const std::vector<MethodDef> methods{ExactDef{}, RelaxationDef{}};
    EXPECT_FALSE(make_solver(build_system(ropes), WorldDef{}, methods, 0.01)->loads().has_value());
}

TEST(BodySolvers, RelaxAllBodiesTogetherWithTheBitsOfEach) {
    const RopeDef ropes[] = {reference::straight_rope(3, 1.0, 60.0), reference::straight_rope(3, 1.0, 50.0)};
    const System system = build_system(ropes);
    const State together = after_2_s(system, {RelaxationDef{}});
    const State alone = after_2_s(build_system({&ropes[1], 1}), {RelaxationDef{}});
    EXPECT_TRUE(std::equal(alone.x_m.begin(), alone.x_m.end(), together.x_m.begin() + 4));
}

TEST(BodySolvers, NameTheBodyThatAMethodRefuses) {
    const Mixed mixed;
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

TEST(StepGrid, TellsTimesBetweenTwoSteps) {
    const GridTime at = locate(0.523, 0.1);
    EXPECT_FALSE(at.is_on_grid);
    EXPECT_EQ(at.step, 5U);
    EXPECT_NEAR(at.fraction, 0.23, 1e-14);
    EXPECT_FALSE(locate(0.1 * (1.0 + 2e-9), 0.1).is_on_grid);
    EXPECT_TRUE(locate(0.1 * (1.0 + 0.5e-9), 0.1).is_on_grid);
    EXPECT_EQ(locate(0.1 * (1.0 - 2e-9), 0.1).step, 0U);
}

TEST(Methods, HaveACostOfAStepThatGrowsWithOrderAndSweeps) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    const RopeDef ring = test::ring(21);
    const Body chain = build_system({&rope, 1}).bodies.front();
    const Body graph = build_system({&ring, 1}).bodies.front();
    EXPECT_GT(step_cost_ns(chain, RattleDef{8}), step_cost_ns(chain, RattleDef{2}));
    EXPECT_GT(step_cost_ns(graph, RattleDef{2}), step_cost_ns(chain, RattleDef{2}));
    EXPECT_EQ(step_cost_ns(chain, RelaxationDef{.sweeps = 5}), 5.0 * step_cost_ns(chain, RelaxationDef{}));
    EXPECT_GT(step_cost_ns(chain, ExactDef{}), 0.0);
}

TEST(Methods, StateTheirWordsStepsAndWhetherTheyKnowTensions) {
    const MethodDef stepped = RattleDef{.order = 6, .step_s = 0.01};
    EXPECT_EQ(method_text(stepped), "rattle of order 6, step 0.01 s");
    EXPECT_EQ(method_text(RelaxationDef{}), "relaxation with 1 sweep");
    EXPECT_EQ(method_text(ExactDef{1e-7}), "exact at tolerance 1e-07");
    EXPECT_EQ(fixed_step_s(stepped), 0.01);
    EXPECT_EQ(fixed_step_s(ExactDef{}), std::nullopt);
    EXPECT_TRUE(knows_tensions(stepped));
    EXPECT_FALSE(knows_tensions(RelaxationDef{}));
}

}  // namespace
}  // namespace corda::sim
