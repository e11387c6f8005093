#include "corda/media/png/png.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"

namespace corda::media {
namespace {

constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

std::uint32_t number_at(std::span<const unsigned char> bytes, std::size_t at) {
    const void* const four = &bytes[at];
    return static_cast<std::uint32_t>(from_big_endian({static_cast<const char*>(four), 4}));
}

/// The head of a chunk: its length and its type (PNG specification, third edition, 5.3).
struct ChunkHead {
    std::array<unsigned char, 8> bytes{};

    [[nodiscard]] std::size_t length() const { return number_at(bytes, 0); }
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

    [[nodiscard]] bool skip(std::size_t count) const {
        return std::fseek(file_.get(), static_cast<long>(count), SEEK_CUR) == 0;
    }

    /// Goes to the next chunk that counts; false if there is none.
    [[nodiscard]] bool find_chunk(ChunkHead& head) const {
        while (read(head.bytes)) {
            if (head.is_of_pixels()) return true;
            if (!skip(head.length() + kCrcBytes)) return false;
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

constexpr std::size_t kBytesOfSignature = 8;

/// "gAMA (1)"; empty for that of sRGB.
std::string words_of_gamma(std::span<const unsigned char> bytes) {
    constexpr std::uint32_t kOfSrgb = 45455;  // 11.3.2.2
    if (bytes.size() != 4 || number_at(bytes, 0) == kOfSrgb) return "";
    return fmt::format("gAMA ({:.6g})", number_at(bytes, 0) / 1e5);
}

/// "cHRM"; empty for the white point and the primaries of sRGB.
std::string words_of_chromaticities(std::span<const unsigned char> bytes) {
    constexpr std::array<std::uint32_t, 8> kOfSrgb{31270, 32900, 64000, 33000,
                                                   30000, 60000, 15000, 6000};  // 11.3.2.1
    bool is_srgb = bytes.size() == 4 * kOfSrgb.size();
    for (std::size_t i = 0; is_srgb && i < kOfSrgb.size(); ++i)
        is_srgb = number_at(bytes, 4 * i) == kOfSrgb[i];
    return is_srgb ? "" : "cHRM";
}

/// "iCCP ('Display P3')": a keyword, a zero and a profile.
std::string words_of_profile(std::span<const unsigned char> bytes) {
    std::string name;
    for (const unsigned char byte : bytes) {
        if (byte == 0) break;
        name += static_cast<char>(byte);
    }
    return fmt::format("iCCP ('{}')", printable(name));
}

/// "cICP (9, 16, 0, 1)": primaries, transfer function, matrix and full range of ITU-T H.273.
std::string words_of_code_points(std::span<const unsigned char> bytes) {
    return fmt::format("cICP ({})", fmt::join(bytes, ", "));
}

bool is_srgb_by_code_points(std::span<const unsigned char> bytes) {
    constexpr std::array<unsigned char, 4> kSrgb{1, 13, 0, 1};
    return std::equal(bytes.begin(), bytes.end(), kSrgb.begin(), kSrgb.end());
}

}  // namespace

std::vector<std::string> color_chunks_beside_srgb(const std::string& path) {
    constexpr int kMaxChunks = 1000;  // before the pixels
    constexpr std::size_t kMaxShownBytes = 80;
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none) || !is_png(path)) return {};
    const ChunkFile file(path);
    if (!file.skip(kBytesOfSignature)) return {};
    std::vector<std::string> found;
    bool is_srgb = false;
    std::optional<bool> is_srgb_for_certain;
    ChunkHead head;
    for (int i = 0; i < kMaxChunks && file.read(head.bytes) && !head.is("IDAT"); ++i) {
        std::array<unsigned char, kMaxShownBytes> block{};
        const auto bytes = std::span(block).first(std::min(head.length(), kMaxShownBytes));
        if (!file.read(bytes) || !file.skip(head.length() - bytes.size() + kCrcBytes)) break;
        std::string words;
        if (head.is("gAMA")) words = words_of_gamma(bytes);
        if (head.is("cHRM")) words = words_of_chromaticities(bytes);
        if (head.is("iCCP")) words = words_of_profile(bytes);
        if (head.is("sRGB")) is_srgb = true;
        if (head.is("cICP")) is_srgb_for_certain = is_srgb_by_code_points(bytes);
        if (head.is("cICP") && !*is_srgb_for_certain) words = words_of_code_points(bytes);
        if (!words.empty()) found.push_back(words);
    }
    return is_srgb_for_certain.value_or(is_srgb) ? std::vector<std::string>{} : found;
}

bool have_same_picture_chunks(const std::string& a, const std::string& b) {
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
