// Cost of the method `exact`: time a particle and step, a particle and evaluation of the right-hand side, and
// the simulated seconds a second, against the number of particles.

#include <benchmark/benchmark.h>

#include "corda/sim/chain_dynamics.hpp"
#include "corda/sim/exact.hpp"
#include "corda/study/ropes.hpp"

namespace corda::sim {
namespace {

void count_particles(benchmark::State& bench, double times) {
    bench.counters["s/particle"] =
        benchmark::Counter(times * static_cast<double>(bench.range(0)),
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void exact_step(benchmark::State& bench) {
    const RopeDef rope = study::straight_rope(static_cast<int>(bench.range(0)), 1.0, 45.0);
    const System system = build_system({&rope, 1}, 1);
    Exact solver(system, WorldDef{}, exact_solver(1e-9), 1.0 / 60.0);
    State state{0.0, system.x_m, system.y_m};
    double time_s = 0.0;
    const double interval_s = 1.0 / static_cast<double>(bench.range(0));
    for (auto _ : bench) {
        time_s += interval_s;
        if (solver.advance_to(time_s, state) != Status::kOk) bench.SkipWithError("diverged");
    }
    count_particles(bench, static_cast<double>(solver.steps() + solver.rejected_steps()));
    bench.counters["simulated_s/s"] = benchmark::Counter(time_s, benchmark::Counter::kIsRate);
}

void exact_derivative(benchmark::State& bench) {
    const RopeDef rope = study::straight_rope(static_cast<int>(bench.range(0)), 1.0, 45.0);
    const System system = build_system({&rope, 1}, 1);
    ChainDynamics dynamics(system, system.bodies, WorldDef{});
    std::vector<double> slope(dynamics.initial_state().size());
    for (auto _ : bench) {
        dynamics.derivative(dynamics.initial_state().data(), slope.data());
        benchmark::DoNotOptimize(slope.data());
        benchmark::ClobberMemory();
    }
    count_particles(bench, static_cast<double>(bench.iterations()));
}

BENCHMARK(exact_step)->Arg(20)->Arg(100)->Arg(1000)->Arg(100'000);
BENCHMARK(exact_derivative)->Arg(20)->Arg(100)->Arg(1000)->Arg(100'000);

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
