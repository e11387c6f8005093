// Cost of method `relaxation` against the number of particles: nanoseconds per bar and step of each kernel.
//
// The kernels take turns in slices of about a millisecond. The figure is the CPU time below which a tenth of
// the slices stay: the load of the machine adds to slices, so longer ones say less about the code.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/relaxation/relaxation.hpp"

namespace corda::sim {
namespace {

const char* name_of(RelaxationKernel kernel) {
    return kernel == RelaxationKernel::kScalar ? "scalar" : "avx2";
}

/// A run by one kernel, timed in slices of some steps.
class TimedRun {
  public:
    TimedRun(const System& system, RelaxationKernel kernel, int steps_a_slice, int steps_at_once)
        : kernel_(kernel),
          steps_(steps_a_slice),
          steps_at_once_(steps_at_once),
          state_{0.0, system.x_m, system.y_m} {
        RelaxationDef def;
        def.force_n = Vec2{0.0, -9.8};
        def.delta = 0.001;
        solver_ = std::make_unique<Relaxation>(system, WorldDef{}, def, 1.0 / 60.0, kernel);
        run_slice();
    }

    void run_slice() {
        const std::clock_t start = std::clock();
        for (int taken = 0; taken < steps_; taken += steps_at_once_) {
            step_ += steps_at_once_;
            benchmark::DoNotOptimize(solver_->advance_to(step_ / 60.0, state_));
        }
        const auto ticks = static_cast<double>(std::clock() - start);
        slices_s_.push_back(ticks / CLOCKS_PER_SEC);
    }

    [[nodiscard]] RelaxationKernel kernel() const { return kernel_; }
    [[nodiscard]] double seconds_a_step() const {
        std::vector<double> sorted = slices_s_;
        std::sort(sorted.begin(), sorted.end());
        return sorted[sorted.size() / 10] / steps_;
    }

  private:
    RelaxationKernel kernel_;
    int steps_;
    int steps_at_once_;
    int step_ = 0;
    State state_;
    std::unique_ptr<Relaxation> solver_;
    std::vector<double> slices_s_;
};

/// Ranges: particles, reach, ropes, steps that each advance_to takes, 0 for all those of a slice.
void relaxation_step(benchmark::State& bench) {
    RopeDef rope = reference::report_rope(static_cast<int>(bench.range(0)));
    rope.reach = static_cast<int>(bench.range(1));
    const std::vector<RopeDef> ropes(static_cast<std::size_t>(bench.range(2)), rope);
    const System system = build_system(ropes);
    const auto bars = static_cast<double>(system.bars.size());
    const int steps = std::max(8, static_cast<int>(200'000.0 / bars));
    const int steps_at_once = bench.range(3) > 0 ? static_cast<int>(bench.range(3)) : steps;
    std::vector<TimedRun> runs;
    for (const RelaxationKernel kernel : relaxation_kernels())
        runs.emplace_back(system, kernel, steps, steps_at_once);
    for (auto _ : bench) {
        for (TimedRun& run : runs) run.run_slice();
    }
    for (const TimedRun& run : runs) {
        const std::string name = name_of(run.kernel());
        bench.counters[name + "_ns/bar"] = 1e9 * run.seconds_a_step() / bars;
        if (&run != &runs.front())
            bench.counters[name + "_gain"] = runs.front().seconds_a_step() / run.seconds_a_step();
    }
    bench.counters["steps/s"] = 1.0 / runs.back().seconds_a_step();
}

BENCHMARK(relaxation_step)
    ->ArgNames({"particles", "reach", "ropes", "steps"})
    ->Args({20, 7, 1, 0})
    ->Args({40, 7, 1, 0})
    ->Args({60, 7, 1, 0})
    ->Args({80, 7, 1, 0})
    ->Args({100, 7, 1, 0})
    ->Args({1000, 7, 1, 0})
    ->Args({10000, 7, 1, 0})
    ->Args({100000, 7, 1, 0})
    ->Args({100, 7, 1, 1})
    ->Args({10000, 7, 1, 1})
    ->Args({20, 7, 20, 0})
    ->Args({100, 1, 1, 0})
    ->Args({100, 3, 1, 0})
    ->Args({1000, 20, 1, 0});

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
