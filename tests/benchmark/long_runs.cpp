// Energy and phase of a pendulum let go at 90 degrees after very many periods, by every tolerance of `exact`
// and order of `rattle`, against the closed form (R2 of src/corda/sim/README.md), as a table in Markdown.
// Usage: benchmark_long_runs [PERIODS], 10 000 by default; a million take some minutes of one core.

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>

#include "benchmark/study/reference/pendulum.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"

namespace corda {
namespace {

double cpu_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void print_row(const MethodDef& method, double periods) {
    constexpr int kSamples = 100;
    const WorldDef world;
    const RopeDef rope = reference::straight_rope(1, 1.0, 90.0);
    const reference::Pendulum truth(std::sqrt(-static_cast<long double>(world.gravity_m_s2.y)),
                                    std::numbers::pi_v<long double> / 2);
    const System system = build_system({&rope, 1});
    Simulation run(system, world, method);
    double phase = 0.0;
    const double start_s = cpu_s();
    for (int k = 1; k <= kSamples; ++k) {
        // At the bottom, where a late pendulum is farthest from where it should be.
        const double time_s = (std::floor(periods * k / kSamples) - 0.25) * truth.period_s();
        if (run.advance_to(time_s) == Status::kDiverged) return;
        const Vec2 at = truth.direction(time_s);
        const double x_m = run.state().x_m[1];
        const double y_m = run.state().y_m[1];
        const double angle = std::atan2(at.x * y_m - at.y * x_m, at.x * x_m + at.y * y_m);
        const double angular_velocity_1_s = std::sqrt(-2.0 * world.gravity_m_s2.y);
        phase = std::max(phase, std::abs(angle) / (angular_velocity_1_s * truth.period_s()));
    }
    // An angle does not tell how late the pendulum is if that is a quarter of a period or more.
    constexpr double kLost = 0.1;
    const Diagnostics diagnostics = run.diagnostics();
    std::printf("| %s | %.3g | %.1f | %.1e | %s |\n", sim::method_text(run.methods().front()).c_str(),
                static_cast<double>(diagnostics.steps) / periods, cpu_s() - start_s,
                *diagnostics.largest.energy_error,
                phase < kLost ? fmt::format("{:.1e}", phase).c_str() : "lost");
    std::fflush(stdout);
}

}  // namespace
}  // namespace corda

int main(int argc, char** argv) {
    using corda::ExactDef, corda::RattleDef;
    const double periods = argc > 1 ? std::atof(argv[1]) : 1e4;
    if (!(periods >= 100.0)) {
        std::fprintf(stderr, "usage: benchmark_long_runs [PERIODS], 100 or more\n");
        return 2;
    }
    std::printf(
        "%g periods\n\n| method | steps per period | CPU s | energy error / (m g L) | phase error / period "
        "|\n"
        "|---|---:|---:|---:|---:|\n",
        periods);
    for (const double tolerance : {1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13})
        corda::print_row(ExactDef{tolerance}, periods);
    for (const int order : {2, 4, 6, 8}) corda::print_row(RattleDef{order, 1.0 / 60.0}, periods);
    for (const int order : {4, 6, 8}) corda::print_row(RattleDef{order, 1.0 / 120.0}, periods);
}
