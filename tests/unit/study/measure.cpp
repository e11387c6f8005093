#include "benchmark/study/measure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "benchmark/study/problems.hpp"
#include "own_problems.hpp"

namespace corda::study {
namespace {

using testing::HasSubstr;

constexpr Timing kNoTiming{0, 0.0};

/// Free fall of two particles side by side; the truth is the closed form plus an error at one frame.
Problem falling_pair(double wrong_by_m) {
    RopeDef pair = reference::rope_through({{0.0, 0.0}, {2.0, 0.0}});
    pair.pinned = {};
    Problem problem = problem_of(pair, 1.0);
    problem.fps = FrameRate(Rational{10, 1});
    problem.reference = [wrong_by_m](std::int64_t k, State& state) {
        const double time_s = 0.1 * static_cast<double>(k);
        const double y_m = -0.5 * 9.81 * time_s * time_s;
        state.x_m = {0.0, 2.0};
        state.y_m = {y_m, y_m + (k == 4 ? wrong_by_m : 0.0)};
        return true;
    };
    return problem;
}

TEST(Measure, GivesErrorsAgainstAClosedForm) {
    const Measurement right = measure(falling_pair(0.0), ExactDef{1e-10}, "exact", 1e-10, Timing{2, 0.001});
    EXPECT_EQ(right.failure, "");
    EXPECT_LT(right.largest_error, 1e-14);  // measured 2e-15
    EXPECT_GT(right.steps, 0U);
    EXPECT_GT(right.ms_per_simulated_s.least(), 0.0);
    EXPECT_LT(right.largest_strain, 1e-14);
    ASSERT_TRUE(right.energy_error.has_value());
    EXPECT_LT(*right.energy_error, 1e-13);

    // One particle of two, 0.3 m of 2 m, at one frame of ten.
    const Measurement wrong = measure(falling_pair(0.3), ExactDef{1e-10}, "exact", 1e-10, kNoTiming);
    EXPECT_TRUE(wrong.ms_per_simulated_s.empty());
    EXPECT_NEAR(wrong.largest_error, 0.15, 1e-13);
    EXPECT_NEAR(wrong.rms_error, 0.15 / std::sqrt(2.0), 1e-13);
}

TEST(Measure, SeesTheErrorOfTheEulerStart) {
    // Relaxation is late by g h t / 2: with h = 0.1 s after 1 s, 0.4905 m of 2 m, of both particles alike.
    const Measurement run = measure(falling_pair(0.0), RelaxationDef{0.1}, "relaxation", 0.1, kNoTiming);
    EXPECT_NEAR(run.largest_error, 0.4905 / 2.0, 1e-13);
    EXPECT_NEAR(run.rms_error, 0.4905 / 2.0, 1e-13);
    EXPECT_EQ(run.steps, 10U);
}

TEST(Measure, LeavesOutWhatTheTruthDoesNotKnow) {
    Problem problem = falling_pair(0.3);
    const Reference all = problem.reference;
    problem.reference = [all](std::int64_t k, State& state) {
        all(k, state);
        state.y_m[1] = std::numeric_limits<double>::quiet_NaN();
        return true;
    };
    EXPECT_LT(measure(problem, ExactDef{1e-10}, "exact", 0.0, kNoTiming).largest_error, 1e-14);
    problem.reference = [all](std::int64_t k, State& state) { return k != 4 && all(k, state); };
    EXPECT_LT(measure(problem, ExactDef{1e-10}, "exact", 0.0, kNoTiming).largest_error, 1e-14);
    problem.reference = nullptr;
    EXPECT_TRUE(std::isnan(measure(problem, ExactDef{1e-10}, "exact", 0.0, kNoTiming).largest_error));
}

TEST(Measure, ShowsARefusalAndADivergenceAsFailures) {
    Problem problem = released_chain();
    EXPECT_THAT(measure(with_reach(problem, 7), ExactDef{1e-9}, "exact", 0.0, kNoTiming).failure,
                HasSubstr("reach"));
    problem.ropes[0].velocity_m_s.back() = {1e300, 0.0};
    EXPECT_THAT(measure(problem, ExactDef{1e-9}, "exact", 0.0, kNoTiming).failure, HasSubstr("diverged"));
}

}  // namespace
}  // namespace corda::study
