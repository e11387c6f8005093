#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace corda::sim {

/// Where a time lies among the whole multiples of a fixed step.
struct GridTime {
    std::uint64_t step = 0;  ///< number of whole steps up to the time
    bool is_on_grid = true;  ///< the time is that of `step`
    double fraction = 0.0;   ///< of the next step, if not
};

/// A time within 1e-9 of n steps counts as n steps, because times that come from a fraction or from decimal
/// text are rounded.
inline GridTime locate(double time_s, double step_s) {
    constexpr double kTolerance = 1e-9;
    const double steps = std::min(time_s / step_s, 0x1p+62);  // what an integer holds
    const double nearest = std::round(steps);
    if (std::abs(steps - nearest) <= kTolerance * std::max(1.0, nearest))
        return {static_cast<std::uint64_t>(nearest), true, 0.0};
    const double whole = std::floor(steps);
    return {static_cast<std::uint64_t>(whole), false, steps - whole};
}

}  // namespace corda::sim
