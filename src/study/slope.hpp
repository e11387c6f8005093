#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>

namespace corda::study {

/// A power law through points.
struct Slope {
    double exponent = 0.0;
    std::size_t points = 0;
};

/// The exponent p of y = c x^p by least squares of log y over log x. Nothing for fewer than three points that
/// have both coordinates above 0 and finite, or all at the same x.
[[nodiscard]] std::optional<Slope> fit_slope(std::span<const std::pair<double, double>> points);

}  // namespace corda::study
