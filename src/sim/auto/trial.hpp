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
    OnProgress on_progress = {};      ///< called for every frame of every trial
    std::function<double()> clock_s;  ///< measures the stepping of each run; empty: not measured
};

/// The factor between the bound on an error and the difference to a tighter run. The error may exceed the
/// difference by the tighter run's own error. Usually 1.01 would be enough, because the check is a hundred
/// times tighter, and at the limit of double precision, where both runs are equally wrong, 2: it is 3. If a
/// string stretches it is 30, because its force has a kink that the error estimates of both runs may miss.
[[nodiscard]] double bound_per_difference(const System& system);

/// Runs the trial's two methods side by side, the check in turned coordinates, so that its rounding differs
/// from the start on, and records in `trial` how far they agree. `recording` is cleared and receives the
/// run's states. Once the difference is too large for good, the check ends; the run goes on to the end if
/// `keeps_going`, because it is then what will be drawn. Each of the two that begins to move adds one to
/// `passes`. Throws corda::Refusal, and corda::Error (kInterrupted) if asked to stop.
void run_trial(const System& system, const WorldDef& world, const PlanDef& def, bool keeps_going,
               Trial& trial, Recording& recording, int& passes);

/// Why a method cannot run a system; std::nullopt if it can.
[[nodiscard]] std::optional<Refusal> refusal(const System& system, const WorldDef& world,
                                             const MethodDef& method, double frame_interval_s);

}  // namespace corda::sim
