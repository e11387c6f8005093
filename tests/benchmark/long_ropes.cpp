// Ropes of 10 to 100 000 links that swing from 30 degrees, at 60 frames per second and 0.1 px of a picture of
// 1080 rows: method `auto`. Processor time per frame of the run, planning over running, the estimate and the
// error against `exact` at 1e-12, in pixels, and the memory of the process so far. Arguments: links, frames,
// and frames that the error is measured over; 0 where the truth would take minutes.

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

double processor_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double error_m(const System& system, const MethodDef& method, int frames) {
    Simulation run(system, WorldDef{}, method);
    Simulation truth(system, WorldDef{}, ExactDef{1e-12});
    double largest_m = 0.0;
    for (int k = 1; k <= frames; ++k) {
        if (run.advance_to(k / 60.0) != Status::kOk || truth.advance_to(k / 60.0) != Status::kOk) return NAN;
        for (std::size_t i = 0; i < system.particle_count(); ++i)
            largest_m = std::max(largest_m, std::hypot(run.state().x_m[i] - truth.state().x_m[i],
                                                       run.state().y_m[i] - truth.state().y_m[i]));
    }
    return largest_m;
}

void swing_of_long_rope(benchmark::State& bench) {
    constexpr double kPixelM = 1.2353 / 1080.0;  // the camera of such a swing
    const RopeDef rope = reference::straight_rope(static_cast<int>(bench.range(0)), 1.0, 30.0);
    const System system = build_system({&rope, 1});
    const auto frames = static_cast<int>(bench.range(1));
    const Timeline timeline(FrameRate(Rational{60, 1}), frames);
    BodyPlan plan;
    double plan_s = 0.0;
    double run_s = 0.0;
    for (auto _ : bench) {
        const double start_s = processor_s();
        Recording recording(system.particle_count(), timeline.size());
        plan = plan_body(system, WorldDef{},
                         {[](const MotionBounds&) { return 0.1 * kPixelM; }, timeline, {}, {}}, recording);
        const double planned_s = processor_s();
        Simulation run(system, WorldDef{}, plan.method);
        for (int k = 1; k <= frames; ++k)
            if (run.advance_to(k / 60.0) != Status::kOk) bench.SkipWithError("diverged");
        plan_s += planned_s - start_s;
        run_s += processor_s() - planned_s;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    bench.SetLabel(method_text(plan.method));
    bench.counters["frame_ms"] = 1e3 * run_s / static_cast<double>(bench.iterations()) / frames;
    bench.counters["plan/run"] = plan_s / run_s;
    bench.counters["estimate_px"] = plan.error_estimate_m.value_or(NAN) / kPixelM;
    const auto compared = static_cast<int>(bench.range(2));
    bench.counters["error_px"] = compared > 0 ? error_m(system, plan.method, compared) / kPixelM : NAN;
    bench.counters["MiB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}

BENCHMARK(swing_of_long_rope)
    ->Args({10, 120, 120})
    ->Args({100, 120, 120})
    ->Args({1000, 60, 60})
    ->Args({10'000, 12, 2})
    ->Args({100'000, 4, 0});

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
