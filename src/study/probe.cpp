#include "corda/study/probe.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "corda/core/error.hpp"

namespace corda::study {

Probe::Probe(const sim::RopeDef& rope, const sim::WorldDef& world, const sim::SolverDef& solver,
             double frame_interval_s)
    : simulation_(sim::build_system({&rope, 1}, solver.reach), world, solver, frame_interval_s) {}

void Probe::go(double time_s) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point from = Clock::now();
    const sim::Status status = simulation_.advance_to(time_s);
    wall_s_ += std::chrono::duration<double>(Clock::now() - from).count();
    if (status == sim::Status::kDiverged)
        throw Error(ExitCode::kDiverged, fmt::format("diverged before {:g} s", time_s));
}

void Probe::go_by_frames(double time_s) {
    constexpr double kFramesPerSecond = 60.0;
    const auto last = std::llround(time_s * kFramesPerSecond);
    for (auto k = std::llround(state().time_s * kFramesPerSecond) + 1; k <= last; ++k)
        go(static_cast<double>(k) / kFramesPerSecond);
}

}  // namespace corda::study
