#include "corda/media/png_chunks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "corda/core/file.hpp"

namespace corda::media {
namespace {

constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

/// What a chunk begins with: its length and its type (PNG specification, third edition, 5.3).
struct ChunkHead {
    std::array<unsigned char, 8> bytes{};

    [[nodiscard]] std::size_t length() const {
        return std::size_t{bytes[0]} << 24U | std::size_t{bytes[1]} << 16U | std::size_t{bytes[2]} << 8U |
               bytes[3];
    }
    [[nodiscard]] bool is(std::string_view type) const { return std::memcmp(&bytes[4], type.data(), 4) == 0; }
    /// Critical chunks have a type that begins with a capital (5.4); of the others transparency counts.
    [[nodiscard]] bool is_of_pixels() const { return (bytes[4] & 0x20U) == 0 || is("tRNS"); }
};

/// Goes to the next chunk that counts; false if there is none.
bool find_chunk(std::FILE* file, ChunkHead& head) {
    while (std::fread(head.bytes.data(), 1, head.bytes.size(), file) == head.bytes.size()) {
        if (head.is_of_pixels()) return true;
        if (std::fseek(file, static_cast<long>(head.length() + kCrcBytes), SEEK_CUR) != 0) return false;
    }
    return false;
}

/// Whether the next bytes of both files are there and equal.
bool are_equal(std::FILE* a, std::FILE* b, std::size_t count) {
    std::array<char, kBlockBytes> block_a{};
    std::array<char, kBlockBytes> block_b{};
    while (count > 0) {
        const std::size_t step = std::min(count, kBlockBytes);
        if (std::fread(block_a.data(), 1, step, a) != step ||
            std::fread(block_b.data(), 1, step, b) != step ||
            std::memcmp(block_a.data(), block_b.data(), step) != 0)
            return false;
        count -= step;
    }
    return true;
}

}  // namespace

bool have_same_picture_chunks(const std::string& a, const std::string& b) {
    constexpr std::size_t kBytesOfSignature = 8;
    std::error_code none;
    if (!std::filesystem::is_regular_file(a, none) || !std::filesystem::is_regular_file(b, none))
        return false;
    const FileHandle of_a = open_for_reading(a);
    const FileHandle of_b = open_for_reading(b);
    if (!are_equal(of_a.get(), of_b.get(), kBytesOfSignature)) return false;
    ChunkHead head_a;
    ChunkHead head_b;
    while (find_chunk(of_a.get(), head_a) && find_chunk(of_b.get(), head_b)) {
        if (head_a.bytes != head_b.bytes) return false;
        if (!are_equal(of_a.get(), of_b.get(), head_a.length() + kCrcBytes)) return false;
        if (head_a.is("IEND")) return true;
    }
    return false;
}

}  // namespace corda::media
