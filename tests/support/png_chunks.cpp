#include "support/png_chunks.hpp"

#include <cstdint>

namespace corda::test {
namespace {

std::string big_endian(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(number >> shift));
    return bytes;
}

/// The CRC of the PNG specification, third edition, 5.5.
std::uint32_t crc_of(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

}  // namespace

std::string with_chunk(const std::string& png, std::string_view type, std::string_view data) {
    constexpr std::size_t kBytesOfEnd = 12;  // of the last chunk
    const std::string checked = std::string(type) + std::string(data);
    const std::string added =
        big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(crc_of(checked));
    return std::string(png).insert(png.size() - kBytesOfEnd, added);
}

}  // namespace corda::test
