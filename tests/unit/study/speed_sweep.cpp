#include "corda/study/speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "own_problems.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

std::ptrdiff_t count(const std::vector<SweepRun>& runs, const std::string& start) {
    return std::count_if(runs.begin(), runs.end(),
                         [&](const SweepRun& run) { return run.label.starts_with(start); });
}

TEST(Sweep, RunsARefusedMethodOncePerSeries) {
    const auto open = sweep_runs(problem_with(reference::straight_rope(5, 1.0, 30.0), 1.0), true);
    EXPECT_GT(count(open, "exact"), 3);
    EXPECT_GT(count(open, "rattle, order 4"), 1);
    const auto closed = sweep_runs(problem_with(test::ring(8), 1.0), true);
    EXPECT_EQ(count(closed, "exact"), 1);
    std::set<std::string> labels;
    for (const SweepRun& run : open) labels.insert(run.label);
    EXPECT_EQ(labels.size(), 2U * 4U + 4U + 1U);  // reaches and sweeps of relaxation, orders of rattle, exact
}

TEST(Sweep, StepsDivideAFrame) {
    Problem problem = problem_with(reference::straight_rope(5, 1.0, 30.0), 1.0);
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
