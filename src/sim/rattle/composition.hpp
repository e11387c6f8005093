#pragma once

#include <span>

namespace corda::sim {

/// A symmetric composition: one step h consists of the steps `stages[0]` h, `stages[1]` h, ... of a symmetric
/// method of order 2, some of them backwards.
struct Composition {
    int order = 2;
    std::span<const double> stages;  ///< symmetric, with the sum 1
    /// Largest omega h, rounded down, up to which the composed leapfrog stays bounded on an oscillation of
    /// angular frequency omega: there the trace of its matrix first leaves [-2, 2].
    double stable_omega_h = 2.0;
};

/// The composition of that order: 2, 4 (Suzuki, 5 stages), 6 (Kahan and Li, 9 stages) or 8 (Kahan and Li, 17
/// stages). The numbers are those of Hairer, Lubich, Wanner, Geometric Numerical Integration, V.3.2.
[[nodiscard]] const Composition& composition(int order);

}  // namespace corda::sim
