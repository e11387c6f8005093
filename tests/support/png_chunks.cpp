#include "support/png_chunks.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>

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

/// Calls `visit` with the type and all bytes of each chunk.
void for_each_chunk(std::string_view png,
                    const std::function<void(std::string_view type, std::string_view chunk)>& visit) {
    constexpr std::size_t kBytesOfSignature = 8;
    for (std::size_t at = kBytesOfSignature; at + 12 <= png.size();) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; ++i) length = length << 8U | static_cast<unsigned char>(png[at + i]);
        visit(png.substr(at + 4, 4), png.substr(at, length + 12));
        at += length + 12;
    }
}

}  // namespace

std::string with_chunk(const std::string& png, std::string_view type, std::string_view data,
                       std::string_view before) {
    const std::string checked = std::string(type) + std::string(data);
    const std::string added =
        big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(crc_of(checked));
    std::string result = png.substr(0, 8);
    bool is_added = false;
    for_each_chunk(png, [&](std::string_view its_type, std::string_view chunk) {
        if (its_type == before && !is_added) result += added;
        is_added |= its_type == before;
        result += chunk;
    });
    return result;
}

std::string without_chunks(const std::string& png, const std::vector<std::string>& types) {
    std::string result = png.substr(0, 8);
    for_each_chunk(png, [&](std::string_view type, std::string_view chunk) {
        if (std::find(types.begin(), types.end(), type) == types.end()) result += chunk;
    });
    return result;
}

}  // namespace corda::test
