#pragma once

#include "corda/sim/auto/trial.hpp"

namespace corda::sim {

/// Finds a method whose positions stay within the tolerance and proves it by tighter runs beside the first.
/// The states of the proved run are left in `recording`: they are what is drawn.
///
/// - Chains, and bodies that stretch: `exact` at the loosest sufficient tolerance, checked by a run a hundred
///   times tighter.
/// - Nets and closed ropes of rigid bars: orders of `rattle` and halved steps, cheapest first, each checked by
///   the next order (8 by 8) at a third of its step.
/// - Bars that depend on each other at the start alone, or that come into line where `rattle` cannot go on:
///   `relaxation`, without a bound on its error.
///
/// The bound is bound_per_difference() times the largest difference of run and checks, and what these cannot
/// see (section 3.6 of src/sim/README.md). If no trial stays within
/// the tolerance to the end, the tightest is taken, with a horizon. Decisions depend on counts and positions,
/// never on a clock: the same scene gives the same plan. Throws corda::Refusal if no method can run the
/// system, and corda::Error (kInterrupted) if asked to stop.
[[nodiscard]] Plan plan_method(const System& system, const WorldDef& world, const PlanDef& def,
                               Recording& recording);

/// The time that a step of a method takes, in nanoseconds, on the machine on which its constants were
/// measured: good for a rough forecast.
[[nodiscard]] double step_cost_ns(const System& system, const MethodDef& method);

}  // namespace corda::sim
