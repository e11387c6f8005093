#pragma once

#include <optional>
#include <vector>

#include "corda/sim/auto/trial.hpp"

namespace corda::sim {

/// Finds a method whose positions stay within the tolerance for the only body of `system`, and verifies it by
/// tighter runs. `recording` then holds the states of the verified run, which are drawn.
///
/// - Chains, and bodies that stretch: `exact` at the loosest sufficient tolerance, checked by runs ten
///   thousand times tighter, as far as rounding lets them be.
/// - Nets and closed ropes of rigid bars: orders of `rattle` and halved steps, cheapest first, each checked by
///   the next order (8 by 8) at a third of its step and guard.
/// - Bars that depend on each other at the start alone: `relaxation`, without a bound on its error.
///
/// The bound is three times the largest difference of run and checks, and what these cannot see (section 3.6
/// of src/sim/README.md). If no trial stays within the tolerance to the end, the tightest is taken, with a
/// horizon. Decisions depend on counts and positions, never on a clock: the same scene gives the same plan.
/// Throws corda::Refusal if no method can run the body, and corda::Error (kInterrupted) if asked to stop.
[[nodiscard]] BodyPlan plan_body(const System& system, const WorldDef& world, const PlanDef& def,
                                 Recording& recording);

/// The method of each body; std::nullopt: plan_body() chooses it.
using NamedMethods = std::vector<std::optional<MethodDef>>;

/// Plans the bodies one after the other; those whose method is named are run by it. The tolerance of each is
/// that for the bounds of its own motion, those of the bodies before it and the start of all. Throws as
/// plan_body().
[[nodiscard]] Plan plan_methods(const System& system, const NamedMethods& named, const WorldDef& world,
                                const PlanDef& def, Recording& recording);

}  // namespace corda::sim
