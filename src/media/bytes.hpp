#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace corda::media {

/// The last `bytes` bytes of a number, the largest first.
[[nodiscard]] inline std::string big_endian(std::uint64_t value, std::size_t bytes) {
    std::string text(bytes, '\0');
    for (std::size_t i = 0; i < bytes; ++i)
        text[i] = static_cast<char>(value >> (8 * (bytes - 1 - i)) & 0xff);
    return text;
}

/// The number that bytes make, the largest first.
[[nodiscard]] inline std::uint64_t from_big_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
    return value;
}

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
