#pragma once

#include <cmath>

namespace corda::sim {

/// The length of (dx, dy). One definition for rest lengths and for distances on the way, so that a bar of
/// unchanged ends has no strain to the last bit. Not std::hypot, whose rounding differs between C libraries.
[[nodiscard]] inline double length(double dx, double dy) {
    return std::sqrt(dx * dx + dy * dy);
}

}  // namespace corda::sim
