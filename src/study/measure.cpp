#include "corda/study/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "corda/core/error.hpp"

namespace corda::study {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

sim::Simulation start(const Problem& problem, const sim::SolverDef& solver, sim::Figured figured) {
    return {sim::build_system(problem.ropes, problem.nets, solver.reach), problem.world, solver,
            problem.frame_interval_s, figured};
}

struct Distance {
    double largest_m = 0.0;
    double rms_m = 0.0;
};

/// Of the particles that the truth knows.
Distance distance(const sim::State& state, const sim::State& truth) {
    double largest_m2 = 0.0;
    double sum_m2 = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        if (std::isnan(truth.x_m[i]) || std::isnan(truth.y_m[i])) continue;
        const double dx = state.x_m[i] - truth.x_m[i];
        const double dy = state.y_m[i] - truth.y_m[i];
        largest_m2 = std::max(largest_m2, dx * dx + dy * dy);
        sum_m2 += dx * dx + dy * dy;
        ++count;
    }
    if (count == 0) return {};
    return {std::sqrt(largest_m2), std::sqrt(sum_m2 / static_cast<double>(count))};
}

/// Runs all frames, compares those that the reference has, and writes down what the run shows.
void watch(const Problem& problem, const sim::SolverDef& solver, Measurement& result) {
    sim::Simulation run = start(problem, solver, sim::Figured::kYes);
    sim::State truth = run.state();
    bool is_compared = false;
    for (std::int64_t k = 1; k <= problem.last_frame; ++k) {
        const double time_s = static_cast<double>(k) * problem.frame_interval_s;
        if (run.advance_to(time_s) == sim::Status::kDiverged) {
            result.failure = "diverged before " + std::to_string(time_s) + " s";
            break;
        }
        if (!problem.reference || !problem.reference(k, truth)) continue;
        is_compared = true;
        const Distance apart = distance(run.state(), truth);
        result.largest_error = std::max(result.largest_error, apart.largest_m / problem.length_m);
        result.rms_error = std::max(result.rms_error, apart.rms_m / problem.length_m);
    }
    if (!is_compared) {
        result.largest_error = std::numeric_limits<double>::quiet_NaN();
        result.rms_error = result.largest_error;
    }
    const sim::Diagnostics shown = run.diagnostics();
    result.largest_strain = shown.largest.strain;
    result.energy_error = shown.largest.energy_error;
    result.steps = shown.steps;
}

/// Seconds that all frames take, the set-up left out; the minimum of the repeats.
double stepping_s(const Problem& problem, const sim::SolverDef& solver, const Timing& timing) {
    double least_s = std::numeric_limits<double>::infinity();
    for (int repeat = 0; repeat < std::max(1, timing.repeats); ++repeat) {
        double sum_s = 0.0;
        int runs = 0;
        do {
            sim::Simulation run = start(problem, solver, sim::Figured::kNo);
            const Clock::time_point from = Clock::now();
            for (std::int64_t k = 1; k <= problem.last_frame; ++k) {
                const double time_s = static_cast<double>(k) * problem.frame_interval_s;
                if (run.advance_to(time_s) == sim::Status::kDiverged) break;
            }
            sum_s += std::chrono::duration<double>(Clock::now() - from).count();
            ++runs;
        } while (sum_s < timing.shortest_s);
        least_s = std::min(least_s, sum_s / runs);
    }
    return least_s;
}

}  // namespace

Measurement measure(const Problem& problem, const sim::SolverDef& solver, const std::string& label,
                    double parameter, const Timing& timing) {
    Measurement result;
    result.solver = solver;
    result.label = label;
    result.parameter = parameter;
    try {
        watch(problem, solver, result);
        if (!result.failure.empty()) return result;
        const double simulated_s = static_cast<double>(problem.last_frame) * problem.frame_interval_s;
        if (simulated_s == 0.0) return result;
        result.ms_per_simulated_s = 1e3 * stepping_s(problem, solver, timing) / simulated_s;
    } catch (const Error& error) {
        result.failure = error.what();
    }
    return result;
}

}  // namespace corda::study
