// Cost of method `exact` against the number of particles: time per particle and step, time per particle and
// evaluation of the right-hand side, and simulated seconds per second. And what Taylor series save: two
// seconds of a swing at 60 frames per second by them and by Dop853, with the error of the last frame.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/chain_series.hpp"
#include "corda/sim/exact/exact.hpp"

namespace corda::sim {
namespace {

void count_particles(benchmark::State& bench, double times) {
    bench.counters["s/particle"] =
        benchmark::Counter(times * static_cast<double>(bench.range(0)),
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void exact_step(benchmark::State& bench) {
    const RopeDef rope = reference::straight_rope(static_cast<int>(bench.range(0)), 1.0, 45.0);
    const System system = build_system({&rope, 1});
    const std::unique_ptr<Exact> solver = Exact::make(system, WorldDef{}, ExactDef{1e-9});
    State state{0.0, system.x_m, system.y_m};
    double time_s = 0.0;
    const double interval_s = 1.0 / static_cast<double>(bench.range(0));
    for (auto _ : bench) {
        time_s += interval_s;
        if (solver->advance_to(time_s, state) != Status::kOk) bench.SkipWithError("diverged");
    }
    count_particles(bench, static_cast<double>(solver->steps() + solver->rejected_steps()));
    bench.counters["simulated_s/s"] = benchmark::Counter(time_s, benchmark::Counter::kIsRate);
}

void exact_derivative(benchmark::State& bench) {
    const RopeDef rope = reference::straight_rope(static_cast<int>(bench.range(0)), 1.0, 45.0);
    const System system = build_system({&rope, 1});
    ChainDynamics dynamics(system, system.bodies, WorldDef{});
    std::vector<double> slope(dynamics.initial_state().size());
    for (auto _ : bench) {
        dynamics.derivative(dynamics.initial_state().data(), slope.data());
        benchmark::DoNotOptimize(slope.data());
        benchmark::ClobberMemory();
    }
    count_particles(bench, static_cast<double>(bench.iterations()));
}

std::unique_ptr<Exact> by_series(const System& system, double tolerance) {
    return std::make_unique<ChainPart>(system, WorldDef{}, tolerance);
}

std::unique_ptr<Exact> by_dop853(const System& system, double tolerance) {
    return std::make_unique<OdePart>(
        system, WorldDef{}, std::make_unique<ChainDynamics>(system, system.bodies, WorldDef{}), tolerance);
}

State swing(Exact& part, const System& system) {
    State state{0.0, system.x_m, system.y_m};
    for (int frame = 1; frame <= 120; ++frame) {
        if (part.advance_to(frame / 60.0, state) != Status::kOk) break;
    }
    return state;
}

/// Arguments: links, and minus the logarithm of the tolerance.
void swing_by(benchmark::State& bench, std::unique_ptr<Exact> (*make_part)(const System&, double)) {
    const RopeDef rope = reference::straight_rope(static_cast<int>(bench.range(0)) + 1, 1.0, 45.0);
    const System system = build_system({&rope, 1});
    State state;
    for (auto _ : bench)
        state = swing(*make_part(system, std::pow(10.0, -static_cast<double>(bench.range(1)))), system);
    const State truth = swing(*by_dop853(system, 1e-15), system);
    double error_m = 0.0;
    for (std::size_t i = 0; i < truth.x_m.size(); ++i)
        error_m = std::max(error_m, std::hypot(state.x_m[i] - truth.x_m[i], state.y_m[i] - truth.y_m[i]));
    bench.counters["error_m"] = error_m;
}

BENCHMARK_CAPTURE(swing_by, series, by_series)->ArgsProduct({{1, 10, 40, 200, 1000}, {3, 6, 9, 12}});
BENCHMARK_CAPTURE(swing_by, dop853, by_dop853)->ArgsProduct({{1, 10, 40, 200, 1000}, {3, 6, 9, 12}});
BENCHMARK(exact_step)->Arg(20)->Arg(100)->Arg(1000)->Arg(100'000);
BENCHMARK(exact_derivative)->Arg(20)->Arg(100)->Arg(1000)->Arg(100'000);

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
