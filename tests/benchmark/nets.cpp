// Cost of rigid nets without diagonals by method `auto`: a grid of 2 m is let go with its side level, pinned
// at a corner, at 60 frames per second and 0.1 px of 1080 in 4.4 m. CPU time per frame of the plan (the run
// and its checks) and of the run alone; the largest error of the last frame, against a run at a hundredth of
// the tightest tolerance of a plan; its estimate; the memory of the process.

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "corda/sim/auto/planner.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

NetDef grid(std::uint32_t size) {
    NetDef net;
    const double spacing_m = 2.0 / (size - 1);
    for (std::uint32_t i = 0; i < size * size; ++i) {
        net.points_m.push_back({spacing_m * (i % size), -spacing_m * (i / size)});
        if (i % size > 0) net.bars.push_back({i - 1, i});
        if (i >= size) net.bars.push_back({i - size, i});
    }
    net.pinned = {0};
    return net;
}

double cpu_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

State state_after(const System& system, const MethodDef& method, int frames) {
    State state{0.0, system.x_m, system.y_m};
    const auto solver = make_solver(system, WorldDef{}, {&method, 1}, 1.0 / 60.0);
    for (int k = 1; k <= frames; ++k) {
        if (solver->advance_to(k / 60.0, state) != Status::kOk) return {};
    }
    return state;
}

/// Arguments: particles along a side, and frames.
void plan_net(benchmark::State& bench) {
    const NetDef net = grid(static_cast<std::uint32_t>(bench.range(0)));
    const System system = build_system({}, {&net, 1});
    const int frames = static_cast<int>(bench.range(1));
    const Timeline timeline(FrameRate(Rational{60, 1}), frames);
    const PlanDef def{[](const MotionBounds&) { return 0.1 * 4.4 / 1080.0; }, timeline, {}, {}};
    for (auto _ : bench) {
        Recording recording(system.particle_count(), 1);
        const double start_s = cpu_s();
        const BodyPlan plan = plan_body(system, WorldDef{}, def, recording);
        const double planned_s = cpu_s();
        const State state = state_after(system, plan.method, frames);
        const double ran_s = cpu_s();
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        bench.counters["memory_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
        const State truth = state_after(system, ExactDef{1e-12}, frames);
        double error_m = 0.0;
        for (std::size_t i = 0; i < truth.x_m.size(); ++i)
            error_m = std::max(error_m, length(state.x_m[i] - truth.x_m[i], state.y_m[i] - truth.y_m[i]));
        bench.counters["plan_ms/frame"] = 1e3 * (planned_s - start_s) / frames;
        bench.counters["run_ms/frame"] = 1e3 * (ran_s - planned_s) / frames;
        bench.counters["error_m"] = error_m;
        bench.counters["estimate_m"] = plan.error_estimate_m.value_or(NAN);
        bench.counters["horizon_s"] = plan.horizon_s.value_or(HUGE_VAL);
        bench.SetLabel(method_text(plan.method));
    }
}

BENCHMARK(plan_net)
    ->ArgNames({"side", "frames"})
    ->ArgsProduct({{10, 30}, {60}})
    ->Args({100, 30})
    ->Args({200, 6})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace corda::sim

BENCHMARK_MAIN();
