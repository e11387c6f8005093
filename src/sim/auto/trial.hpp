#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "corda/core/basics.hpp"
#include "corda/core/timeline.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/refusal.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The tolerance of positions in metres, > 0, for a motion with these bounds. It must not fall when the
/// bounds grow.
using ToleranceOf = std::function<double(const MotionBounds&)>;

/// What a plan has to achieve: positions within a tolerance of the truth at every frame time of the timeline.
struct PlanDef {
    ToleranceOf tolerance_m;
    Timeline timeline;
    OnProgress on_progress = {};      ///< called for every frame of every trial, and during long ones
    std::function<double()> clock_s;  ///< measures the stepping of each run; empty: not measured
};

/// Tells on_progress that `frames_done` of the timeline are done. Both must outlive it.
[[nodiscard]] GoesOn reporting(const PlanDef& def, const std::int64_t& frames_done);

/// The place of a trial among those of a plan.
struct TrialKind {
    bool is_first = true;  ///< if of `rattle`, it has one check
    bool is_last = true;   ///< its run is what will be drawn: it goes on to the end without its checks
};

/// Runs the trial's method and its checks side by side, the checks in turned coordinates, so that their
/// rounding differs from the start on, and records in `trial` how far they agree. A run whose error is not
/// far above rounding has three checks, and what these differ by counts twice. `recording` is cleared and
/// receives the run's states. Once the difference is too large for good, the checks end. Each that begins to
/// move adds one to `passes`. Throws corda::Refusal, and corda::Error (kInterrupted) if asked to stop.
void run_trial(const System& system, const WorldDef& world, const PlanDef& def, TrialKind kind, Trial& trial,
               Recording& recording, int& passes);

/// Why a method cannot run a system; std::nullopt if it can.
[[nodiscard]] std::optional<Refusal> refusal(const System& system, const WorldDef& world,
                                             const MethodDef& method, double frame_interval_s,
                                             const GoesOn& goes_on = {});

}  // namespace corda::sim
