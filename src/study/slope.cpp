#include "corda/study/slope.hpp"

#include <cmath>

namespace corda::study {

std::optional<Slope> fit_slope(std::span<const std::pair<double, double>> points) {
    const auto usable = [](double value) { return value > 0.0 && std::isfinite(value); };
    std::size_t count = 0;
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (const auto& [x, y] : points) {
        if (!usable(x) || !usable(y)) continue;
        ++count;
        mean_x += (std::log(x) - mean_x) / static_cast<double>(count);
        mean_y += (std::log(y) - mean_y) / static_cast<double>(count);
    }
    if (count < 3) return std::nullopt;
    double sum_xx = 0.0;
    double sum_xy = 0.0;
    for (const auto& [x, y] : points) {
        if (!usable(x) || !usable(y)) continue;
        sum_xx += (std::log(x) - mean_x) * (std::log(x) - mean_x);
        sum_xy += (std::log(x) - mean_x) * (std::log(y) - mean_y);
    }
    if (!(sum_xx > 0.0)) return std::nullopt;
    return Slope{sum_xy / sum_xx, count};
}

}  // namespace corda::study
