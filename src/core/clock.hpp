#pragma once

#include <chrono>

#include "corda/core/basics.hpp"

namespace corda {

/// Seconds on a clock that only goes forward.
[[nodiscard]] inline double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Returns true for 0.4 s after a request to stop: work that is nearly done may finish in this time.
[[nodiscard]] inline GoesOn for_a_moment() {
    constexpr double kMomentS = 0.4;
    return [end_s = now_s() + kMomentS] { return now_s() < end_s; };
}

}  // namespace corda
