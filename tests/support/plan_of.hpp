#pragma once

#include "corda/sim/auto/planner.hpp"

namespace corda::test {

/// The plan of `auto` for a system, with positions accurate to `tolerance_m` up to a frame.
inline BodyPlan plan_of(const System& system, const WorldDef& world, double tolerance_m, FrameRate frames,
                        std::int64_t last_frame) {
    sim::Recording recording(system.particle_count(), 1);
    const auto tolerance = [tolerance_m](const MotionBounds&) { return tolerance_m; };
    return sim::plan_body(system, world, {tolerance, Timeline(frames, last_frame), {}, {}}, recording);
}

}  // namespace corda::test
