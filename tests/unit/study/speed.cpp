#include "benchmark/study/speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "benchmark/study/chapters.hpp"
#include "own_problems.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

TEST(Times, HaveAMiddleAndEnds) {
    Times times;
    EXPECT_EQ(times.median(), 0.0);
    for (const double time : {3.0, 1.0, 10.0}) times.add(time);
    EXPECT_EQ(times.median(), 3.0);
    times.add(2.0);
    EXPECT_EQ(times.median(), 2.5);
    EXPECT_EQ(times.least(), 1.0);
    EXPECT_EQ(times.times(10.0).largest(), 100.0);
}

std::ptrdiff_t count(const std::vector<SweepRun>& runs, const std::string& start) {
    return std::count_if(runs.begin(), runs.end(),
                         [&](const SweepRun& run) { return run.label.starts_with(start); });
}

TEST(Sweep, RunsARefusedMethodOncePerSeries) {
    const auto open = sweep_runs(problem_of(reference::straight_rope(5, 1.0, 30.0), 1.0), true);
    EXPECT_GT(count(open, "exact"), 3);
    EXPECT_GT(count(open, "rattle, order 4"), 1);
    const auto closed = sweep_runs(problem_of(test::stiff_ring(8), 1.0), true);
    EXPECT_EQ(count(closed, "exact"), 1);
    std::set<std::string> labels;
    for (const SweepRun& run : open) labels.insert(run.label);
    EXPECT_EQ(labels.size(), 2U * 4U + 4U + 1U);  // reaches and sweeps of relaxation, orders of rattle, exact
}

TEST(Speed, OfASceneShowsFailedRuns) {
    Options options;
    options.quick = true;
    options.scene = scene_with(test::stiff_ring(6), 0.1);
    int calls = 0;
    const nlohmann::json result = measure_speed(options, [&](const std::string& what) {
        EXPECT_FALSE(what.empty());
        ++calls;
    });
    ASSERT_EQ(result.at("problems").size(), 1U);
    const nlohmann::json& problem = result["problems"][0];
    EXPECT_EQ(problem.at("id"), "own_rope_1");
    EXPECT_TRUE(
        problem.at("truth_of_exact").is_null());  // exact cannot run a closed rope that resists bending
    EXPECT_EQ(problem.at("runs").size(), static_cast<std::size_t>(calls - 1));
    int failed = 0;
    for (const nlohmann::json& run : problem["runs"]) {
        EXPECT_GT(run.at("parameter"), 0.0);
        if (run.contains("failure")) {
            ++failed;
            const std::string series = run.at("series");
            EXPECT_TRUE(series == "exact" || series.starts_with("relaxation")) << series;
            continue;
        }
        EXPECT_TRUE(run.at("error_rms_over_length").is_number()) << run;
        EXPECT_LE(run.at("error_rms_over_length"), run.at("error_largest_over_length")) << run;
        EXPECT_LE(run.at("ms_least"), run.at("ms_per_simulated_s")) << run;
        EXPECT_LE(run.at("ms_per_simulated_s"), run.at("ms_largest")) << run;
        EXPECT_GT(run.at("steps"), 0) << run;
    }
    EXPECT_EQ(failed, 1 + 2 * 4);  // exact, and reaches and sweeps of relaxation
}

TEST(Sweep, StepsDivideAFrame) {
    Problem problem = problem_of(reference::straight_rope(5, 1.0, 30.0), 1.0);
    problem.fps = FrameRate(Rational{24, 1});
    for (const SweepRun& run : sweep_runs(problem, false)) {
        if (run.label == "exact") continue;
        const double steps = problem.fps.interval_s() / run.parameter;
        EXPECT_NEAR(steps, std::round(steps), 1e-9) << run.label << " " << run.parameter;
        EXPECT_LE(run.parameter, problem.fps.interval_s());
    }
}

}  // namespace
}  // namespace corda::study
