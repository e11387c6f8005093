#pragma once

#include <vector>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// The inverse masses of a system, 0 also for particles that can never move because they lie on a row of
/// rigid bars that is straight between two that cannot: the top row of a net between its pinned corners. To
/// first order the bars of such a row say nothing of its sideways motion, so a ConstraintSolver could not
/// keep it.
[[nodiscard]] std::vector<double> inverse_masses_with_taut_rows_held(const System& system);

}  // namespace corda::sim
