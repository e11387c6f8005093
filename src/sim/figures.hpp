#pragma once

#include <optional>

#include "corda/sim/simulation.hpp"

namespace corda::sim {

/// The larger of each figure at two times; that of one time if it is not known at the other.
[[nodiscard]] Figures larger_figures(const Figures& a, const Figures& b);

/// The larger loads of two bodies; std::nullopt unless both are known.
[[nodiscard]] std::optional<Loads> loads_of_both(const std::optional<Loads>& a,
                                                 const std::optional<Loads>& b);

/// Figures::energy_error; std::nullopt if the change is NaN, which is not known, or there is nothing to
/// compare it with.
[[nodiscard]] std::optional<double> energy_error(double change_j, double scale_j);

}  // namespace corda::sim
