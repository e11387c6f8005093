#include "corda/study/speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "own_problems.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

TEST(Speed, TakesTheCheapestRunThatMeetsTheError) {
    std::vector<Measurement> runs(4);
    runs[0].rms_error = 1e-2;
    runs[0].ms_per_simulated_s.add(1.0);
    runs[1].rms_error = 1e-5;
    for (const double ms : {1.0, 5.0, 5.1}) runs[1].ms_per_simulated_s.add(ms);
    runs[2].rms_error = 1e-7;
    runs[2].ms_per_simulated_s.add(3.0);
    runs[3].failure = "diverged";  // its error of 0 does not count
    EXPECT_EQ(cheapest_within(runs, 1e-1), &runs[0]);
    EXPECT_EQ(cheapest_within(runs, 1e-4), &runs[2]);
    EXPECT_EQ(cheapest_within(runs, 1e-9), nullptr);
    runs[1].rms_error = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cheapest_within(runs, 1e-5), &runs[2]);
}

TEST(Times, HaveAMiddleAndEnds) {
    report::Times times;
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
    const auto closed = sweep_runs(problem_of(test::ring(8), 1.0), true);
    EXPECT_EQ(count(closed, "exact"), 1);
    std::set<std::string> labels;
    for (const SweepRun& run : open) labels.insert(run.label);
    EXPECT_EQ(labels.size(), 2U * 4U + 4U + 1U);  // reaches and sweeps of relaxation, orders of rattle, exact
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
