#pragma once

#include <cstddef>
#include <cstdint>
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

}  // namespace corda::media
