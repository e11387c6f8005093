#pragma once

#include <cstdint>
#include <optional>

namespace corda::media {

// Arithmetic on numbers from files of any origin: std::nullopt in place of an overflow, which in signed
// numbers is undefined.

template <typename T>
[[nodiscard]] std::optional<T> checked_add(T a, T b) {
    T result = 0;
    return __builtin_add_overflow(a, b, &result) ? std::nullopt : std::optional<T>(result);
}

template <typename T>
[[nodiscard]] std::optional<T> checked_multiply(T a, T b) {
    T result = 0;
    return __builtin_mul_overflow(a, b, &result) ? std::nullopt : std::optional<T>(result);
}

/// Whether a time stamp can be right. Those that are not, among them AV_NOPTS_VALUE, are so large that sums
/// of a few of them overflow: 2^60 ticks of the finest clock, 2^-32 s, are eight years.
[[nodiscard]] inline bool is_sane_stamp(std::int64_t ticks) {
    constexpr std::int64_t kLargest = std::int64_t{1} << 60;
    return ticks >= -kLargest && ticks <= kLargest;
}

}  // namespace corda::media
