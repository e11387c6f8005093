// What section 5 of src/corda/sim/README.md asks of all methods: the same bytes from two processes, no work
// on denormal numbers; of method auto, the same positions at every frame rate.

#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "stability/denormal_trap.hpp"
#include "support/command.hpp"
#include "support/plan_of.hpp"

namespace corda::sim {
namespace {

class EveryMethod : public testing::TestWithParam<MethodDef> {};

TEST_P(EveryMethod, WritesTheSameBytesFromTwoProcesses) {
    const test::ScratchFolder folder;
    const std::string scene = folder.write(
        "scene.toml",
        "schema = 1\n[world]\nduration = 2.0\n[[rope]]\nhang = { links = 20, length = 1.0, angle_deg = "
        "80.0 }\n");
    const auto run = [&](const std::string& name) {
        const std::string csv = folder.file(name);
        const auto result = test::run_corda({"simulate", scene, "-o", csv, "--diagnostics", "--set",
                                             "solver.method=" + std::string(method_name(GetParam()))});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return test::read_file(csv);
    };
    const std::string first = run("a.csv");
    EXPECT_GT(first.size(), 10'000U);
    EXPECT_TRUE(first == run("b.csv"));
}

/// Halving its distance to equilibrium again and again, a rope would reach denormal numbers, which slow a
/// step down a hundred times. What the steps cost is measured by `tests/benchmark/study.py hard_cases`.
TEST_P(EveryMethod, NeverWorksOnDenormalNumbersWhileAMotionDiesDown) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    const WorldDef world{{0.0, -9.81}, 2000.0, 5.0};
    MethodDef method = GetParam();
    constexpr double kStepSeconds = 1.0 / 500.0;  // 1e6 steps; exact has its own
    if (auto* rattle = std::get_if<RattleDef>(&method)) *rattle = {2, kStepSeconds};
    if (auto* relaxation = std::get_if<RelaxationDef>(&method)) relaxation->step_s = kStepSeconds;
    Simulation run(build_system({&rope, 1}), world, method);
    {
        const test::DenormalTrap trap;
        for (int k = 1; k <= 2000; ++k) ASSERT_EQ(run.advance_to(k), Status::kOk);
    }
    // Measured: exactly 0 except for exact, 7e-27, whose steps follow its tolerance.
    EXPECT_NEAR(run.state().x_m.back(), 0.0, std::holds_alternative<ExactDef>(method) ? 1e-20 : 1e-100);
    // With one sweep per step relaxation is 7.5 mm too long.
    EXPECT_NEAR(run.state().y_m.back(), -1.0, std::holds_alternative<RelaxationDef>(method) ? 0.01 : 1e-13);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethod,
                         testing::Values(RelaxationDef{1.0 / 960.0}, RattleDef{8}, ExactDef{1e-9}),
                         [](const auto& param) { return std::string(method_name(param.param)); });

TEST(Auto, AgreesAtCommonTimesOfAllFrameRatesWithinItsTolerance) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    const System system = build_system({&rope, 1});
    constexpr double kToleranceM = 1e-5;
    std::vector<State> ends;
    for (const int rate : {24, 30, 60, 120}) {
        const FrameRate frames(Rational{rate, 1});
        const BodyPlan plan = test::plan_of(system, WorldDef{}, kToleranceM, frames, 2 * rate);
        ASSERT_FALSE(plan.horizon_s.has_value());
        Simulation run(system, WorldDef{}, plan.method, frames.interval_s());
        ASSERT_EQ(run.advance_to(2.0), Status::kOk);
        ends.push_back(run.state());
    }
    for (const State& end : ends) {
        for (std::size_t i = 0; i <= 20; ++i) {
            const double apart_m =
                std::hypot(end.x_m[i] - ends.front().x_m[i], end.y_m[i] - ends.front().y_m[i]);
            EXPECT_LE(apart_m, 2.0 * kToleranceM);  // each is within the tolerance of the truth
        }
    }
}

}  // namespace
}  // namespace corda::sim
