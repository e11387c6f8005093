#pragma once

#include <cmath>
#include <span>
#include <utility>

namespace corda::test {

/// The exponent p of y = c x^p by least squares of log y over log x. All coordinates are positive.
inline double slope(std::span<const std::pair<double, double>> points) {
    const auto n = static_cast<double>(points.size());
    double sum_x = 0.0;
    double sum_y = 0.0;
    double sum_xx = 0.0;
    double sum_xy = 0.0;
    for (const auto& [x, y] : points) {
        sum_x += std::log(x);
        sum_y += std::log(y);
        sum_xx += std::log(x) * std::log(x);
        sum_xy += std::log(x) * std::log(y);
    }
    return (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
}

}  // namespace corda::test
