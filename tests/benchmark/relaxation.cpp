// Cost of the relaxation method: time a bar and a step, against the number of particles.

#include <benchmark/benchmark.h>

#include "corda/sim/relaxation.hpp"
#include "support/ropes.hpp"

namespace corda::sim {
namespace {

void relaxation_step(benchmark::State& bench) {
    const RopeDef rope = test::report_rope(static_cast<int>(bench.range(0)));
    const System system = build_system({&rope, 1}, static_cast<int>(bench.range(1)));
    SolverDef def;
    def.force_n = Vec2{0.0, -9.8};
    def.delta = 0.001;
    Relaxation solver(system, WorldDef{}, def, 1.0 / 60.0);
    State state{0.0, system.x_m, system.y_m};
    constexpr int kStepsPerIteration = 64;
    int k = 0;
    for (auto _ : bench) {
        k += kStepsPerIteration;
        if (solver.advance_to(k / 60.0, state) != Status::kOk) bench.SkipWithError("diverged");
        benchmark::DoNotOptimize(state.x_m.data());
    }
    const double steps = static_cast<double>(bench.iterations()) * kStepsPerIteration;
    bench.counters["steps/s"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
    bench.counters["s/bar"] = benchmark::Counter(steps * static_cast<double>(system.bars.size()),
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(relaxation_step)
    ->ArgNames({"particles", "reach"})
    ->Args({20, 7})
    ->Args({40, 7})
    ->Args({80, 7})
    ->Args({100, 7})
    ->Args({1000, 7})
    ->Args({10000, 7})
    ->Args({100, 1});

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
