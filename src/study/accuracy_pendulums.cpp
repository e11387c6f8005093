// R1 to R3 and R10 of PHYSICS section 4.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "corda/study/accuracy.hpp"
#include "corda/study/pendulum.hpp"
#include "corda/study/problems.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/sweep.hpp"

namespace corda::study {
namespace {

constexpr double kGravity = 9.81;

void add_r1(const StudyDef& def, std::vector<AccuracyRow>& rows) {
    const Problem problem = a01_pendulum().subject.problem;
    const AccuracyRow named = named_row("R1", "2000 s", "position / L");
    const std::array<NamedMethod, 3> methods{{{"exact, 1e-9", sim::exact_solver(1e-9)},
                                              {"exact, 1e-13", sim::exact_solver(1e-13)},
                                              {"rope, order 8", sim::rope_solver(8, 1.0 / 100.0)}}};
    add_problem_rows(named, problem, methods, study_timing(def.quick), rows);
}

/// A relative error of a time at which the tip passes under the pin at a speed: from where it is then.
void add_passage(const AccuracyRow& named, const sim::RopeDef& rope, double time_s, double speed_m_s,
                 std::vector<AccuracyRow>& rows) {
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-13", sim::exact_solver(1e-13)},
         {"rope, order 8", sim::rope_solver(8, time_s / std::ceil(400.0 * time_s))}}};
    const auto error_of = [&](Probe& probe) {
        probe.go(time_s);
        return std::abs(probe.tip_m().x) / (speed_m_s * time_s);
    };
    add_probe_rows(named, rope, sim::WorldDef{}, methods, time_s, error_of, rows);
}

void add_r2(const StudyDef& /*def*/, std::vector<AccuracyRow>& rows) {
    for (const SwingPeriod& row : kSwingPeriods) {
        const double speed_m_s =
            std::sqrt(2.0 * kGravity * (1.0 - std::cos(row.angle_deg * std::numbers::pi / 180.0)));
        const AccuracyRow named =
            named_row("R2", fmt::format("{:g} deg", row.angle_deg),
                      row.angle_deg > 175 ? "period, relative, near the top" : "period, relative");
        // A quarter of a period after the start and a whole one after that.
        add_passage(named, straight_rope(1, 1.0, row.angle_deg), 1.25 * row.ratio * kSmallSwingSeconds,
                    speed_m_s, rows);
    }
    sim::RopeDef rope = straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * kGravity), 0.0};
    const AccuracyRow named = named_row("R2", "circulating", "period, relative");
    add_passage(named, rope, 3.0 * kFullTurnSeconds, std::sqrt(6.0 * kGravity), rows);
}

/// When relaxation with all of its bars converged gets to the vertical, in s.
double quarter_period_s(int links, double step_s, AccuracyRow& row) {
    const sim::SolverDef solver = sim::relaxation_solver(step_s, 7, 1000);
    Probe probe(straight_rope(links, 1.0, 90.0), sim::WorldDef{}, solver);
    double before_m = 1.0;
    for (int k = 1; k * step_s < 1.0; ++k) {
        probe.go(k * step_s);
        const double x_m = probe.tip_m().x;
        row.wall_ms = 1e3 * probe.wall_s();
        if (x_m <= 0.0) return (k - x_m / (x_m - before_m)) * step_s;
        before_m = x_m;
    }
    return 1.0;
}

void add_r3(const StudyDef& def, std::vector<AccuracyRow>& rows) {
    for (const RodPeriod& rod : kRodPeriods) {
        if (def.quick && rod.links > 10) continue;
        AccuracyRow row = named_row(
            "R3", fmt::format("{} masses from the horizontal, step 1/2000 s", rod.links), "period, relative");
        row.method = "relaxation, 7 n bars, 1000 sweeps";
        add_row(
            row,
            [&](AccuracyRow& filled) {
                const double quarter_s = quarter_period_s(rod.links, 1.0 / 2000.0, filled);
                filled.error = std::abs(4.0 * quarter_s / rod.period_s - 1.0);
                filled.ms_per_simulated_s = filled.wall_ms / quarter_s;
            },
            rows);
    }
}

void add_r10(const StudyDef& /*def*/, std::vector<AccuracyRow>& rows) {
    constexpr double kStepSeconds = 1.0 / 60.0;
    constexpr double kForceNewtons = -9.8;
    for (const double delta : {0.001, 0.01, 0.1}) {
        const AccuracyRow row = named_row("R10", fmt::format("delta {:g}, 10 s", delta), "fall, relative");
        sim::RopeDef pair = rope_through({{0.0, 0.0}, {1.0, 0.0}});
        pair.pinned = {};
        sim::SolverDef solver = sim::relaxation_solver(kStepSeconds, 1, 1);
        solver.delta = delta;
        solver.force_n = sim::Vec2{0.0, kForceNewtons};
        const auto error_of = [&](Probe& probe) {
            double largest = 0.0;
            for (int n = 1; n <= 600; ++n) {
                probe.go(n * kStepSeconds);
                // The first step is Euler's and does not fall.
                if (n == 1) continue;
                const double fall_m = damped_fall_m(1.0, kStepSeconds, n, delta, kForceNewtons);
                largest = std::max(largest, std::abs(probe.tip_m().y / fall_m - 1.0));
            }
            return largest;
        };
        const std::array<NamedMethod, 1> methods{{{"relaxation", solver}}};
        add_probe_rows(row, pair, sim::WorldDef{}, methods, 10.0, error_of, rows);
    }
}

}  // namespace

std::vector<AccuracyCase> pendulum_cases() {
    return {{"R1", "IFToMM A01 pendulum, 2000 s", add_r1},
            {"R2", "period at large angles", add_r2},
            {"R3", "rigid rod", add_r3},
            {"R10", "damped free fall", add_r10}};
}

}  // namespace corda::study
