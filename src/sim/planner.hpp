#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/sim/trial.hpp"

namespace corda::sim {

/// The method `auto` runs, and the proof that it is good enough.
struct Plan {
    SolverDef solver;  ///< never kAuto
    /// Of the position of any particle at any frame time up to the horizon. Nothing where no method can tell
    /// how the system truly moves: bars that depend on each other.
    std::optional<double> error_bound_m;
    /// The time after which no method's positions mean anything: a run and a much tighter one differ by more
    /// than the tolerance. Nothing where the scene ends before.
    std::optional<double> horizon_s;
    bool diverges = false;      ///< the horizon is where even the best trial gave up
    std::vector<Trial> trials;  ///< all that were tried, the chosen one last
    std::string reason;         ///< in words: why this method
};

/// Finds the cheapest method whose positions stay within `def.tolerance_m`, and proves it by a second,
/// tighter run in step with the first.
///
/// - Chains and bodies that stretch: the loosest tolerance of `exact` that does, checked by a run a hundred
///   times tighter; then any order of `rope` that by step_cost_ns() is cheaper, checked by that same tight
///   run of the other formulation.
/// - Nets and closed ropes of rigid bars: orders of `rope` and halved steps, cheapest first, each checked by
///   the next order (8 by itself) at half its step.
/// - Bars whose lengths depend on each other (a net with diagonals), at the start or on the way:
///   `relaxation`, and no bound.
///
/// The bound is bound_per_difference() times the largest difference of the two runs. Everything is decided by
/// counts and positions, never by a clock: the same scene gives the same plan. Throws corda::Error
/// (kInvalidScene) where no method can run the system.
[[nodiscard]] Plan plan_solver(const System& system, const WorldDef& world, const PlanDef& def);

/// A quick method that can run the system at all, to some 1e-6 of its size where a method can tell: what a
/// camera is fitted by before there is a plan. Throws as plan_solver() does.
[[nodiscard]] SolverDef scouting_solver(const System& system, const WorldDef& world, double frame_interval_s);

/// What a step of a method costs, in nanoseconds on the machine that the table in the source was measured on:
/// good for the choice between methods and for a rough forecast.
[[nodiscard]] double step_cost_ns(const System& system, const SolverDef& solver);

}  // namespace corda::sim
