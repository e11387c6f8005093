#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>

namespace corda::study {

/// The exponent of a power law fitted to points.
struct Slope {
    double exponent = 0.0;
    std::size_t points = 0;
};

/// The exponent p of y = c x^p by least squares of log y over log x. Points with a coordinate that is not
/// finite or not above 0 are left out; std::nullopt if fewer than three remain, or if all have the same x.
[[nodiscard]] std::optional<Slope> fit_slope(std::span<const std::pair<double, double>> points);

}  // namespace corda::study
