// What a study measures, against truths known in advance, and what it says of figures that are made up.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "corda/core/error.hpp"
#include "corda/study/pendulum.hpp"
#include "corda/study/problems.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/slope.hpp"
#include "corda/study/statements.hpp"
#include "corda/study/study.hpp"
#include "corda/study/sweep.hpp"
#include "support/nets.hpp"
#include "support/reference_files.hpp"

namespace corda::study {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr Timing kNoTiming{1, 0.0};

TEST(Pendulum, IsTheA01Benchmark) {
    const Pendulum pendulum(std::sqrt(9.81L), std::numbers::pi_v<long double> / 2.0L);
    double largest_m = 0.0;
    int rows = 0;
    for (const sim::Vec2& expected : test::read_a01()) {
        const sim::Vec2 bob = pendulum.direction(0.5L * ++rows);
        largest_m = std::max(largest_m, std::hypot(bob.x - expected.x, bob.y - expected.y));
    }
    EXPECT_EQ(rows, 4000);
    EXPECT_LT(largest_m, 1e-14);  // measured 8e-16
}

TEST(Pendulum, HasThePeriodsOfR2AndR3) {
    for (const auto& [angle_deg, ratio] : kSwingPeriods) {
        if (angle_deg > 179.0) continue;  // the rounding of 179.9 itself shows in the period: 4e-14
        const long double angle =
            static_cast<long double>(angle_deg) * std::numbers::pi_v<long double> / 180.0L;
        const Pendulum pendulum(std::sqrt(9.81L), angle);
        EXPECT_NEAR(pendulum.period_s() / kSmallSwingSeconds, ratio, 4e-15) << angle_deg;  // measured 4e-16
    }
    for (const auto& [masses, period_s] : kRodPeriods) {
        const Pendulum rod(rod_omega0_1_s(masses, 1.0 / masses, 9.81),
                           std::numbers::pi_v<long double> / 2.0L);
        EXPECT_NEAR(rod.period_s(), period_s, 4e-15) << masses;  // measured 2e-16
    }
}

/// Free fall of two particles side by side, in closed form but for an error put in on purpose.
Problem falling_pair(double wrong_by_m) {
    sim::RopeDef pair = rope_through({{0.0, 0.0}, {2.0, 0.0}});
    pair.pinned = {};
    Problem problem;
    problem.ropes = {pair};
    problem.length_m = 2.0;
    problem.frame_interval_s = 0.1;
    problem.last_frame = 10;
    problem.reference = [wrong_by_m](std::int64_t k, sim::State& state) {
        const double time_s = 0.1 * static_cast<double>(k);
        const double y_m = -0.5 * 9.81 * time_s * time_s;
        state.x_m = {0.0, 2.0};
        state.y_m = {y_m, y_m + (k == 4 ? wrong_by_m : 0.0)};
        return true;
    };
    return problem;
}

TEST(Measure, GivesErrorsAgainstAClosedForm) {
    const Measurement right =
        measure(falling_pair(0.0), sim::exact_solver(1e-10), "exact", 1e-10, Timing{2, 0.001});
    EXPECT_EQ(right.failure, "");
    EXPECT_LT(right.largest_error, 1e-14);  // measured 2e-15
    EXPECT_GT(right.steps, 0U);
    EXPECT_GT(right.ms_per_simulated_s, 0.0);
    EXPECT_LT(right.largest_strain, 1e-14);
    ASSERT_TRUE(right.energy_error.has_value());
    EXPECT_LT(*right.energy_error, 1e-13);

    // One particle of two, 0.3 m of 2 m, at one frame of ten.
    const Measurement wrong = measure(falling_pair(0.3), sim::exact_solver(1e-10), "exact", 1e-10, kNoTiming);
    EXPECT_NEAR(wrong.largest_error, 0.15, 1e-13);
    EXPECT_NEAR(wrong.rms_error, 0.15 / std::sqrt(2.0), 1e-13);
}

TEST(Measure, SeesTheErrorOfTheEulerStart) {
    // Relaxation is late by g h t / 2: with h = 0.1 s after 1 s, 0.4905 m of 2 m, of both particles alike.
    const Measurement run =
        measure(falling_pair(0.0), sim::relaxation_solver(0.1, 1, 1), "relaxation", 0.1, kNoTiming);
    EXPECT_NEAR(run.largest_error, 0.4905 / 2.0, 1e-13);
    EXPECT_NEAR(run.rms_error, 0.4905 / 2.0, 1e-13);
    EXPECT_EQ(run.steps, 10U);
}

TEST(Measure, LeavesOutWhatTheTruthDoesNotKnow) {
    Problem problem = falling_pair(0.3);
    const Reference all = problem.reference;
    problem.reference = [all](std::int64_t k, sim::State& state) {
        all(k, state);
        state.y_m[1] = std::numeric_limits<double>::quiet_NaN();
        return true;
    };
    EXPECT_LT(measure(problem, sim::exact_solver(1e-10), "exact", 0.0, kNoTiming).largest_error, 1e-14);
    problem.reference = [all](std::int64_t k, sim::State& state) { return k != 4 && all(k, state); };
    EXPECT_LT(measure(problem, sim::exact_solver(1e-10), "exact", 0.0, kNoTiming).largest_error, 1e-14);
    problem.reference = nullptr;
    EXPECT_TRUE(
        std::isnan(measure(problem, sim::exact_solver(1e-10), "exact", 0.0, kNoTiming).largest_error));
}

TEST(Measure, ShowsARefusalAndADivergenceAsFailures) {
    Problem problem = released_chain().subject.problem;
    sim::SolverDef with_bars = sim::exact_solver(1e-9);
    with_bars.reach = 7;
    EXPECT_THAT(measure(problem, with_bars, "exact", 0.0, kNoTiming).failure, HasSubstr("reach"));
    problem.ropes[0].velocity_m_s.back() = {1e300, 0.0};
    EXPECT_THAT(measure(problem, sim::exact_solver(1e-9), "exact", 0.0, kNoTiming).failure,
                HasSubstr("diverged"));
}

TEST(Slope, IsTheExponentOfAPowerLaw) {
    std::vector<std::pair<double, double>> points;
    for (const double h : {0.1, 0.05, 0.02, 0.01}) points.emplace_back(h, 3.0 * std::pow(h, 4.0));
    const auto slope = fit_slope(points);
    ASSERT_TRUE(slope.has_value());
    EXPECT_NEAR(slope->exponent, 4.0, 1e-12);
    EXPECT_EQ(slope->points, 4U);
    // By hand: x = 0, 1, 2 and y = 0, 2, 1 in powers of e.
    const double e = std::numbers::e;
    const std::vector<std::pair<double, double>> scattered{{1.0, 1.0}, {e, e * e}, {e * e, e}};
    EXPECT_NEAR(fit_slope(scattered)->exponent, 0.5, 1e-14);
}

TEST(Slope, NeedsThreePoints) {
    std::vector<std::pair<double, double>> points{{0.1, 1e-3}, {0.05, 1e-4}};
    EXPECT_FALSE(fit_slope(points).has_value());
    points.emplace_back(0.02, 0.0);  // has no logarithm
    points.emplace_back(0.01, std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(fit_slope(points).has_value());
    const std::vector<std::pair<double, double>> one_step(5, {0.1, 1e-3});
    EXPECT_FALSE(fit_slope(one_step).has_value());
}

TEST(Truth, OfEachMethodIsMadeByAnother) {
    BuiltInProblem swing = released_chain();
    find_truth(swing.subject);
    EXPECT_THAT(facing(swing.subject, sim::Method::kRope).truth, HasSubstr("exact"));
    EXPECT_THAT(facing(swing.subject, sim::Method::kRelaxation).truth, HasSubstr("exact"));
    EXPECT_THAT(facing(swing.subject, sim::Method::kExact).truth, HasSubstr("rope"));
    EXPECT_FALSE(swing.subject.horizon_s.has_value());
    ASSERT_EQ(swing.published.size(), 2U);
    for (const sim::Method method : {sim::Method::kRope, sim::Method::kExact}) {
        // measured 9e-16 and 2.9e-14
        EXPECT_LT(distance_from_published(facing(swing.subject, method), swing.published), 1e-12);
    }
    EXPECT_LT(swing.subject.disagreement.value(), 1e-12);  // measured 1.1e-14
}

Problem problem_of(const sim::RopeDef& rope, double duration_s) {
    Problem problem;
    problem.id = "own";
    problem.title = "A scene";
    problem.ropes = {rope};
    problem.length_m = length_m(rope);
    problem.last_frame = std::lround(60.0 * duration_s);
    return problem;
}

TEST(Truth, EndsAtTheHorizonOfAChaoticMotion) {
    Subject subject;
    subject.problem = problem_of(straight_rope(10, 1.0, 90.0), 6.0);
    find_truth(subject);
    ASSERT_TRUE(subject.horizon_s.has_value());
    // PHYSICS R5: a perturbation grows by 1e15 in 5 s, and past 2 s positions are not to be compared.
    EXPECT_GT(*subject.horizon_s, 1.5);  // measured 2.4
    EXPECT_LT(*subject.horizon_s, 4.5);
    const auto last = std::lround(60.0 * *subject.horizon_s);
    sim::State state;
    for (const sim::Method method : {sim::Method::kRope, sim::Method::kExact}) {
        const Problem problem = facing(subject, method);
        EXPECT_TRUE(problem.reference(last, state));
        EXPECT_FALSE(problem.reference(last + 1, state));
    }
    EXPECT_LE(subject.disagreement.value(), kHorizonDifference);
}

TEST(Truth, SaysWhereOneMethodAloneOrNoneCanTell) {
    Subject ring;
    ring.problem = problem_of(test::ring(8), 0.2);
    find_truth(ring);
    EXPECT_THAT(facing(ring, sim::Method::kRope).truth, HasSubstr("run of itself"));
    EXPECT_TRUE(ring.problem.reference);

    Subject cloth;
    cloth.problem.id = "cloth";
    cloth.problem.nets = {test::leaning_net(3, 3, 0.5, true)};
    cloth.problem.last_frame = 5;
    find_truth(cloth);
    EXPECT_THAT(cloth.problem.truth, HasSubstr("none"));
    EXPECT_FALSE(cloth.problem.reference);
}

TEST(Sweep, RunsARefusedMethodOnceASeries) {
    const auto count = [](const std::vector<SweepRun>& runs, const std::string& start) {
        return std::count_if(runs.begin(), runs.end(),
                             [&](const SweepRun& run) { return run.label.starts_with(start); });
    };
    const auto open = sweep_runs(problem_of(straight_rope(5, 1.0, 30.0), 1.0), true);
    EXPECT_GT(count(open, "exact"), 3);
    EXPECT_GT(count(open, "rope, order 4"), 1);
    EXPECT_EQ(count(sweep_runs(problem_of(test::ring(8), 1.0), true), "exact"), 1);
    std::set<std::string> labels;
    for (const SweepRun& run : open) labels.insert(run.label);
    EXPECT_EQ(labels.size(), 2U * 4U + 4U + 1U);  // reaches and sweeps of relaxation, orders of rope, exact
}

TEST(Sweep, TakesTheCheapestRunThatMeetsTheError) {
    std::vector<Measurement> runs(4);
    runs[0].rms_error = 1e-2;
    runs[0].ms_per_simulated_s = 1.0;
    runs[1].rms_error = 1e-5;
    runs[1].ms_per_simulated_s = 5.0;
    runs[2].rms_error = 1e-7;
    runs[2].ms_per_simulated_s = 3.0;
    runs[3].failure = "diverged";  // its error of 0 says nothing
    EXPECT_EQ(cheapest_within(runs, 1e-1), &runs[0]);
    EXPECT_EQ(cheapest_within(runs, 1e-4), &runs[2]);
    EXPECT_EQ(cheapest_within(runs, 1e-9), nullptr);
    runs[1].rms_error = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cheapest_within(runs, 1e-5), &runs[2]);
}

SwingRow row_of(double mass_kg, int reach, double rope_error, double strain, int sweeps = 1) {
    SwingRow row;
    row.def = {40, mass_kg, reach, sweeps};
    row.figures = {strain, rope_error, 0.01, 0.0, 4.0 / std::sqrt(mass_kg), {}};
    return row;
}

TEST(Statements, ChooseTheirWordsByTheFigures) {
    std::vector<SwingRow> rows;
    for (const double mass_kg : {0.1, 1.0, 10.0}) {
        for (const int reach : {1, 2, 7}) rows.push_back(row_of(mass_kg, reach, 1.0 / reach, 0.1 / mass_kg));
    }
    EXPECT_THAT(best_reach_statement(rows), HasSubstr("reach 7, 7, 7, as the report found."));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("less and less, as the report found"));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("no effect at all"));
    EXPECT_THAT(mass_statement(rows, 0.1), Not(HasSubstr("no effect")));
    EXPECT_THAT(speed_statement(rows), HasSubstr("livelier, as the report found"));
    EXPECT_THAT(speed_statement(rows), HasSubstr("12.6, 4, 1.26 m/s; the force"));
    EXPECT_THAT(speed_statement(rows), HasSubstr("would be 12.6, 4, 1.26 m/s"));
    EXPECT_THAT(light_statement(rows), HasSubstr("the links stretch more, yet"));

    // The other way round: few bars are best, and mass makes the rope softer.
    for (SwingRow& row : rows) row.figures.rope_error = row.def.reach;
    for (SwingRow& row : rows) row.figures.strain = row.def.mass_kg;
    for (SwingRow& row : rows) row.figures.tip_speed_m_s = row.def.mass_kg;
    EXPECT_THAT(speed_statement(rows), HasSubstr("not livelier, against the report's finding"));
    EXPECT_THAT(best_reach_statement(rows), HasSubstr("reach 1, 1, 1, against the report's finding."));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("against the report's finding"));
    EXPECT_THAT(light_statement(rows), HasSubstr("does not deteriorate, against the report's finding"));
    rows[2].figures.rope_error = 100.0;
    rows[2].figures.strain = 100.0;
    EXPECT_THAT(light_statement(rows), HasSubstr("the motion deteriorates, as the report found"));
}

TEST(Statements, OfSizesSweepsAndSettling) {
    std::vector<SwingRow> rows{row_of(1.0, 1, 0.1, 0.1), row_of(1.0, 1, 0.1, 0.5), row_of(1.0, 7, 0.1, 0.05)};
    rows[0].def.particles = 20;
    rows[1].def.particles = rows[2].def.particles = 100;
    EXPECT_THAT(many_particles_statement(rows), HasSubstr("as the report found"));
    rows[1].figures.strain = rows[2].figures.strain = 0.1;
    EXPECT_THAT(many_particles_statement(rows), HasSubstr("against the report's finding"));

    std::vector<SwingRow> passes{row_of(1.0, 7, 0.02, 0.1), row_of(1.0, 7, 0.04, 0.1, 16)};
    EXPECT_THAT(sweeps_statement(passes),
                HasSubstr("the error against the true rope grows from 0.02 to 0.04"));
    EXPECT_THAT(sweeps_statement(passes), HasSubstr("nearer to the rod"));
    passes[1].figures.rope_error = 0.005;
    EXPECT_THAT(sweeps_statement(passes), HasSubstr("nearer to the true rope"));

    const Settling damped{0.01, 1.0 / 60.0, 0.6, 20.0, 21.0};
    const Settling own_loss{0.0, 1.0 / 60.0, 0.0, 300.0, std::nullopt};
    EXPECT_THAT(settling_statement(std::vector{own_loss, damped}, 600.0), HasSubstr("the method's own loss"));
    const Settling never{0.0, 1.0 / 60.0, 0.0, std::nullopt, std::nullopt};
    EXPECT_THAT(settling_statement(std::vector{never, damped}, 600.0), HasSubstr("It takes damping"));
    EXPECT_THAT(settling_statement(std::vector{never, damped}, 600.0), HasSubstr("1 of 1 settle"));
}

TEST(Study, OfASceneShowsFailedRunsAndFillsItsTables) {
    StudyDef def;
    def.quick = true;
    def.problem = problem_of(test::ring(6), 0.1);
    int calls = 0;
    int last = 0;
    const Report report = run_study(def, [&](int done, int of, const std::string& what) {
        EXPECT_LE(done, of);
        EXPECT_FALSE(what.empty());
        ++calls;
        last = of - done;
    });
    EXPECT_GT(calls, 10);
    EXPECT_EQ(last, 0);
    ASSERT_EQ(report.chapters.size(), 1U);
    std::set<std::string> ids;
    bool has_failed_row = false;
    for (const Table& table : report.chapters[0].tables) {
        EXPECT_TRUE(ids.insert(table.id).second) << table.id;
        for (const auto& row : table.rows) {
            ASSERT_EQ(row.size(), table.columns.size()) << table.id;
            const auto* text = std::get_if<std::string>(&row.back());
            if (table.columns.back().key != kFailureKey || text == nullptr) continue;
            has_failed_row = true;
            EXPECT_EQ(std::get<std::string>(row[0]), "exact");
        }
    }
    EXPECT_TRUE(has_failed_row);  // exact refuses a closed rope
}

TEST(Study, KnowsItsChapters) {
    StudyDef def;
    def.chapters = {"colours"};
    EXPECT_THROW(static_cast<void>(run_study(def, nullptr)), Error);
    def.chapters = {"hard_cases"};
    def.problem = problem_of(straight_rope(5, 1.0, 30.0), 0.1);
    EXPECT_THROW(static_cast<void>(run_study(def, nullptr)), Error);
    for (const std::string& name : chapter_names())
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos);
}

}  // namespace
}  // namespace corda::study
