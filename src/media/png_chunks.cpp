#include "corda/media/png_chunks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
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

/// A file that is being read from its beginning on.
class ChunkFile {
  public:
    explicit ChunkFile(const std::string& path) : path_(path), file_(open_for_reading(path)) {}

    /// Fills `bytes` with the next ones; false if they are not there.
    [[nodiscard]] bool read(std::span<unsigned char> bytes) const {
        void* const to = bytes.data();
        return read_bytes(file_, path_, static_cast<char*>(to), bytes.size()) == bytes.size();
    }

    /// Goes to the next chunk that counts; false if there is none.
    [[nodiscard]] bool find_chunk(ChunkHead& head) const {
        while (read(head.bytes)) {
            if (head.is_of_pixels()) return true;
            if (std::fseek(file_.get(), static_cast<long>(head.length() + kCrcBytes), SEEK_CUR) != 0)
                return false;
        }
        return false;
    }

  private:
    std::string path_;
    FileHandle file_;
};

/// Whether the next bytes of both files are there and equal.
bool are_equal(const ChunkFile& a, const ChunkFile& b, std::size_t count) {
    std::array<unsigned char, kBlockBytes> block_a{};
    std::array<unsigned char, kBlockBytes> block_b{};
    while (count > 0) {
        const std::size_t step = std::min(count, kBlockBytes);
        if (!a.read(std::span(block_a).first(step)) || !b.read(std::span(block_b).first(step)) ||
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
    const ChunkFile of_a(a);
    const ChunkFile of_b(b);
    if (!are_equal(of_a, of_b, kBytesOfSignature)) return false;
    ChunkHead head_a;
    ChunkHead head_b;
    while (of_a.find_chunk(head_a) && of_b.find_chunk(head_b)) {
        if (head_a.bytes != head_b.bytes) return false;
        if (!are_equal(of_a, of_b, head_a.length() + kCrcBytes)) return false;
        if (head_a.is("IEND")) return true;
    }
    return false;
}

}  // namespace corda::media
