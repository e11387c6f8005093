#pragma once

#include <cstdint>
#include <string>

#include "corda/core/rational.hpp"
#include "corda/sim/frame_watch.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// What a plan has to reach: the positions at the frame times 0 .. last_frame within a distance of the truth.
struct PlanDef {
    double tolerance_m = 0.0;  ///< > 0; of the position of any particle
    FrameRate frames;
    std::int64_t last_frame = 0;
    FrameWatch watch = {};  ///< of every trial
};

/// A method that was tried, and how far it stayed from a tighter run.
struct Trial {
    SolverDef solver;
    SolverDef check;  ///< the tighter run it was compared with
    std::uint64_t steps = 0;
    std::uint64_t check_steps = 0;
    double largest_difference_m = 0.0;  ///< up to `reached_s`
    double reached_s = 0.0;             ///< the last frame time up to which it was within the tolerance
    bool to_the_end = false;
    bool diverged = false;  ///< one of the two runs gave up after `reached_s`
};

/// The true error may be larger than the difference to a tighter run by that run's own error. Normally 1.01
/// would do, since the check is a hundred times tighter; at the limit of double precision both runs are
/// equally wrong, and 2 would: 3 is claimed. Where strings stretch, their force has a kink that a step's
/// error estimate may miss in either run: 30.
[[nodiscard]] double bound_per_difference(const System& system);

/// Runs the trial's two solvers frame by frame, the check in turned coordinates (another rounding from the
/// start on), until they part by more than the tolerance allows, or to the end, and writes down how far they
/// got. Throws corda::Error where one of them cannot run the system.
void run_trial(const System& system, const WorldDef& world, const PlanDef& def, Trial& trial);

/// Why a solver cannot run a system, in the words of its error; empty where it can.
[[nodiscard]] std::string refusal(const System& system, const WorldDef& world, const SolverDef& solver,
                                  double frame_interval_s);

}  // namespace corda::sim
