#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// What a plan has to reach: the positions at the frame times 0 .. last_frame within a distance of the truth.
struct PlanDef {
    double tolerance_m = 0.0;  ///< > 0; of the position of any particle
    FrameRate frames;
    std::int64_t last_frame = 0;
};

/// A method that was tried, and how far it stayed from a tighter run.
struct Trial {
    SolverDef solver;
    SolverDef check;  ///< the tighter run it was compared with
    std::uint64_t steps = 0;
    double largest_difference_m = 0.0;  ///< up to `reached_s`
    double reached_s = 0.0;             ///< the last frame time up to which it was within the tolerance
    bool to_the_end = false;
};

/// The method `auto` runs, and the proof that it is good enough.
struct Plan {
    SolverDef solver;            ///< never kAuto
    double error_bound_m = 0.0;  ///< of the position of any particle at any frame time up to the horizon
    /// The time after which no method's positions mean anything: a run and a hundred times tighter one differ
    /// by more than the tolerance. Nothing where the scene ends before.
    std::optional<double> horizon_s;
    std::vector<Trial> trials;  ///< all that were tried, the chosen one last
    std::string reason;         ///< in words: why this method
};

/// Finds the loosest tolerance of `exact` whose positions stay within `def.tolerance_m`, and proves it by a
/// second, a hundred times tighter run in step with the first.
///
/// The bound is kBoundPerDifference times the largest difference of the two runs. Everything is decided by
/// counts and positions, never by a clock: the same scene gives the same plan. Throws corda::Error
/// (kInvalidScene) where no method can run the system.
[[nodiscard]] Plan plan_solver(const System& system, const WorldDef& world, const PlanDef& def);

/// The true error may be larger than the difference to a tighter run by that run's own error. Normally 1.01
/// would do, since the check is a hundred times tighter; at the limit of double precision both runs are
/// equally wrong, and 2 would.
inline constexpr double kBoundPerDifference = 3.0;

}  // namespace corda::sim
