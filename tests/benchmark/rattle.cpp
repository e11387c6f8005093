// Cost of method `rattle`: time per particle and step, against the number of particles and the order.

#include <benchmark/benchmark.h>

#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/rattle/rattle.hpp"

namespace corda::sim {
namespace {

void rattle_step(benchmark::State& bench) {
    const int links = static_cast<int>(bench.range(0));
    const RopeDef rope = reference::straight_rope(links, 1.0, 45.0);
    const System system = build_system({&rope, 1});
    // The step that a scene of order 4 is given: the same share of the shortest period at every size.
    const double step_s = Rattle(system, WorldDef{}, RattleDef{4}, 1.0).step_s();
    Rattle solver(system, WorldDef{}, RattleDef{static_cast<int>(bench.range(1)), step_s}, 1.0 / 60.0);
    State state{0.0, system.x_m, system.y_m};
    const int steps = links > 10000 ? 4 : 64;
    int k = 0;
    for (auto _ : bench) {
        k += steps;
        if (solver.advance_to(k * step_s, state) != Status::kOk) bench.SkipWithError("diverged");
        benchmark::DoNotOptimize(state.x_m.data());
    }
    const double taken = static_cast<double>(bench.iterations()) * steps;
    bench.counters["s/particle-step"] =
        benchmark::Counter(taken * links, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    bench.counters["parts/step"] = static_cast<double>(solver.parts()) / static_cast<double>(solver.steps());
}

BENCHMARK(rattle_step)->ArgNames({"links", "order"})->ArgsProduct({{1, 20, 100, 1000, 100000}, {2, 4, 6, 8}});

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
