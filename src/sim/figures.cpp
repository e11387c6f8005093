#include "corda/sim/figures.hpp"

#include <algorithm>
#include <cmath>

namespace corda::sim {
namespace {

Loads larger_loads(const Loads& a, const Loads& b) {
    return {std::max(a.pin_force_n, b.pin_force_n), std::max(a.largest_tension_n, b.largest_tension_n)};
}

}  // namespace

Figures larger_figures(const Figures& a, const Figures& b) {
    Figures larger;
    larger.strain = std::max(a.strain, b.strain);
    if (a.energy_error || b.energy_error)
        larger.energy_error = std::max(a.energy_error.value_or(0.0), b.energy_error.value_or(0.0));
    if (a.loads || b.loads) larger.loads = larger_loads(a.loads.value_or(Loads{}), b.loads.value_or(Loads{}));
    return larger;
}

std::optional<Loads> loads_of_both(const std::optional<Loads>& a, const std::optional<Loads>& b) {
    if (!a || !b) return std::nullopt;
    return larger_loads(*a, *b);
}

std::optional<double> energy_error(double change_j, double scale_j) {
    if (std::isnan(change_j) || !(scale_j > 0.0)) return std::nullopt;
    return std::abs(change_j) / scale_j;
}

}  // namespace corda::sim
