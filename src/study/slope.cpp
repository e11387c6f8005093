#include "corda/study/slope.hpp"

#include <cmath>
#include <vector>

namespace corda::study {

std::optional<Slope> fit_slope(std::span<const std::pair<double, double>> points) {
    std::vector<std::pair<double, double>> logs;
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (const auto& [x, y] : points) {
        if (!(x > 0.0 && y > 0.0 && std::isfinite(x) && std::isfinite(y))) continue;
        logs.emplace_back(std::log(x), std::log(y));
        mean_x += logs.back().first;
        mean_y += logs.back().second;
    }
    if (logs.size() < 3) return std::nullopt;
    mean_x /= static_cast<double>(logs.size());
    mean_y /= static_cast<double>(logs.size());
    double sum_xx = 0.0;
    double sum_xy = 0.0;
    for (const auto& [x, y] : logs) {
        sum_xx += (x - mean_x) * (x - mean_x);
        sum_xy += (x - mean_x) * (y - mean_y);
    }
    // Equal logarithms leave the rounding of their mean.
    if (!(sum_xx > 1e-24)) return std::nullopt;
    return Slope{sum_xy / sum_xx, logs.size()};
}

}  // namespace corda::study
