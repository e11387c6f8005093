#include "corda/study/probe.hpp"

#include <cmath>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/clock.hpp"
#include "corda/study/step.hpp"

namespace corda::study {

Probe::Probe(const RopeDef& rope, const WorldDef& world, const MethodDef& method, double frame_interval_s)
    : simulation_(build_system({&rope, 1}), world, method, frame_interval_s) {}

void Probe::go(double time_s) {
    check_cancelled();
    const double from_s = now_s();
    const Status status = simulation_.advance_to(time_s, check_cancelled);
    wall_s_ += now_s() - from_s;
    if (status == Status::kDiverged)
        throw Error(ExitCode::kDiverged, fmt::format("diverged before {:.6g} s", time_s));
}

void Probe::go_by_frames(double time_s, double frames_per_second) {
    const auto last = std::llround(time_s * frames_per_second);
    for (auto k = std::llround(state().time_s * frames_per_second) + 1; k <= last; ++k)
        go(static_cast<double>(k) / frames_per_second);
}

}  // namespace corda::study
