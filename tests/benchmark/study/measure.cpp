#include "benchmark/study/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/sim/solver.hpp"

namespace corda::study {
namespace {

/// Compares the particles that the truth knows.
void compare(const State& state, const State& truth, double length_m, Measurement& result) {
    double largest_m2 = 0.0;
    double sum_m2 = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const double dx = state.x_m[i] - truth.x_m[i];
        const double dy = state.y_m[i] - truth.y_m[i];
        if (std::isnan(truth.x_m[i]) || std::isnan(truth.y_m[i])) continue;
        largest_m2 = std::max(largest_m2, dx * dx + dy * dy);
        sum_m2 += dx * dx + dy * dy;
        ++count;
    }
    if (count == 0) return;
    result.largest_error = std::max(result.largest_error, std::sqrt(largest_m2) / length_m);
    result.rms_error = std::max(result.rms_error, std::sqrt(sum_m2 / count) / length_m);
}

/// Runs all frames, compares those that the reference knows, and notes what the run shows.
void watch(const Problem& problem, Measurement& result) {
    Simulation run(problem.system(), problem.world, result.method, problem.fps.interval_s());
    State truth = run.state();
    bool is_compared = false;
    for (std::int64_t k = 1; k <= problem.last_frame(); ++k) {
        const double time_s = problem.fps.time_s(k);
        if (run.advance_to(time_s) == Status::kDiverged) {
            result.failure = fmt::format("diverged before {:.6g} s", time_s);
            return;
        }
        if (!problem.reference || !problem.reference(k, truth)) continue;
        is_compared = true;
        compare(run.state(), truth, problem.length_m, result);
    }
    if (!is_compared) result.largest_error = result.rms_error = std::numeric_limits<double>::quiet_NaN();
    const Diagnostics shown = run.diagnostics();
    result.largest_strain = shown.largest.strain;
    result.energy_error = shown.largest.energy_error;
    result.steps = shown.steps;
}

/// Seconds that all frames take without the set-up. The bare solver is timed, without the figures that a
/// Simulation works out.
Times stepping_s(const Problem& problem, const MethodDef& method, const Timing& timing) {
    const System system = problem.system();
    const std::int64_t last_frame = problem.last_frame();
    Times times_s;
    for (int repeat = 0; repeat < timing.repeats; ++repeat) {
        double sum_s = 0.0;
        int runs = 0;
        do {
            const auto solver =
                sim::make_solver(system, problem.world, {&method, 1}, problem.fps.interval_s());
            State state{0.0, system.x_m, system.y_m};
            const double from_s = now_s();
            for (std::int64_t k = 1; k <= last_frame; ++k) {
                if (solver->advance_to(problem.fps.time_s(k), state) == Status::kDiverged) break;
            }
            sum_s += now_s() - from_s;
            ++runs;
        } while (sum_s < timing.shortest_s);
        times_s.add(sum_s / runs);
    }
    return times_s;
}

}  // namespace

double rms_m(const State& a, const State& b) {
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < a.x_m.size(); ++i) {
        const double dx = a.x_m[i] - b.x_m[i];
        const double dy = a.y_m[i] - b.y_m[i];
        sum_m2 += dx * dx + dy * dy;
    }
    return std::sqrt(sum_m2 / static_cast<double>(a.x_m.size()));
}

Problem with_reach(Problem problem, int reach) {
    for (RopeDef& rope : problem.ropes) rope.reach = reach;
    return problem;
}

Measurement measure(const Problem& problem, const MethodDef& method, const std::string& label,
                    double parameter, const Timing& timing) {
    Measurement result;
    result.method = method;
    result.label = label;
    result.parameter = parameter;
    try {
        watch(problem, result);
        const double simulated_s = problem.fps.time_s(problem.last_frame());
        if (result.failure.empty() && timing.repeats > 0 && simulated_s > 0.0)
            result.ms_per_simulated_s = stepping_s(problem, method, timing).times(1e3 / simulated_s);
    } catch (const Error& error) {
        result.failure = error.what();
    }
    return result;
}

Probe::Probe(const RopeDef& rope, const WorldDef& world, const MethodDef& method, double frame_interval_s)
    : simulation_(build_system({&rope, 1}), world, method, frame_interval_s) {}

void Probe::go(double time_s) {
    const double from_s = now_s();
    const Status status = simulation_.advance_to(time_s);
    wall_s_ += now_s() - from_s;
    if (status == Status::kDiverged) throw_error(ExitCode::kDiverged, "diverged before {:.6g} s", time_s);
}

void Probe::go_by_frames(double time_s, double frames_per_second) {
    const auto last = std::llround(time_s * frames_per_second);
    for (auto k = std::llround(state().time_s * frames_per_second) + 1; k <= last; ++k)
        go(static_cast<double>(k) / frames_per_second);
}

}  // namespace corda::study
