#pragma once

#include <cmath>

namespace corda::sim {

/// The length of (dx, dy) in the unit of its arguments. One definition for rest lengths and running
/// distances, so that a bar at rest is at rest to the last bit. Not std::hypot, whose rounding differs
/// between C libraries.
[[nodiscard]] inline double length(double dx, double dy) {
    return std::sqrt(dx * dx + dy * dy);
}

}  // namespace corda::sim
