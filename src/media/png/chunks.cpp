#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/png/png.hpp"

namespace corda::media {
namespace {

/// True for chunks that read_png() shows: critical ones have a type that begins with a capital (5.4); of the
/// others transparency counts.
bool is_of_pixels(const PngChunk& chunk) {
    return (chunk.type[0] & 0x20) == 0 || chunk.type == "tRNS";
}

/// The next chunk of pixels; std::nullopt if there is none.
std::optional<PngChunk> next_chunk_of_pixels(ByteReader& bytes) {
    for (auto chunk = next_png_chunk(bytes); chunk; chunk = next_png_chunk(bytes)) {
        if (is_of_pixels(*chunk)) return chunk;
        if (!bytes.skip(chunk->length + PngChunk::kChecksumBytes)) return std::nullopt;
    }
    return std::nullopt;
}

/// True if the next bytes of both files are there and equal.
bool are_equal(ByteReader& a, ByteReader& b, std::uint64_t count) {
    constexpr std::uint64_t kBlockBytes = std::uint64_t{1} << 16;
    while (count > 0) {
        const std::uint64_t step = std::min(count, kBlockBytes);
        const std::string bytes = a.take(step);
        if (bytes.size() < step || bytes != b.take(step)) return false;
        count -= step;
    }
    return true;
}

/// "gAMA (1)"; empty for that of sRGB.
std::string gamma_text(std::string_view bytes) {
    constexpr std::uint64_t kSrgb = 45455;  // 11.3.2.2
    const std::uint64_t gamma = from_big_endian(bytes);
    return bytes.size() != 4 || gamma == kSrgb
               ? ""
               : fmt::format("gAMA ({:.6g})", static_cast<double>(gamma) / 1e5);
}

/// "cHRM"; empty for the white point and the primaries of sRGB.
std::string chromaticities_text(std::string_view bytes) {
    constexpr std::array<std::uint64_t, 8> kSrgb{31270, 32900, 64000, 33000,
                                                 30000, 60000, 15000, 6000};  // 11.3.2.1
    std::string srgb;
    for (const std::uint64_t value : kSrgb) srgb += big_endian(value, 4);
    return bytes == srgb ? "" : "cHRM";
}

/// "iCCP ('Display P3')": a keyword, a zero and a profile.
std::string profile_text(std::string_view bytes) {
    return fmt::format("iCCP ('{}')", printable(std::string(bytes.substr(0, bytes.find('\0')))));
}

/// "cICP (9, 16, 0, 1)": primaries, transfer function, matrix and full range of ITU-T H.273.
std::string code_points_text(std::string_view bytes) {
    std::vector<int> numbers;
    for (const char byte : bytes) numbers.push_back(static_cast<unsigned char>(byte));
    return fmt::format("cICP ({})", fmt::join(numbers, ", "));
}

bool is_regular(const std::string& path) {
    std::error_code none;
    return std::filesystem::is_regular_file(path, none);
}

}  // namespace

std::vector<std::string> color_chunks_beside_srgb(const std::string& path) {
    constexpr int kMaxChunks = 1000;  // before the pixels
    constexpr std::uint64_t kMaxShownBytes = 80;
    constexpr std::string_view kSrgbCodePoints("\1\15\0\1", 4);
    if (!is_regular(path) || !is_png(path)) return {};
    ByteReader file = ByteReader::of_file(path);
    if (!file.skip(kPngSignature.size())) return {};
    std::vector<std::string> found;
    bool is_srgb = false;
    std::optional<bool> is_srgb_for_certain;
    for (int i = 0; i < kMaxChunks; ++i) {
        const auto chunk = next_png_chunk(file);
        if (!chunk || chunk->type == "IDAT") break;
        const std::string bytes = file.take(std::min(chunk->length, kMaxShownBytes));
        if (!file.skip(chunk->length - bytes.size() + PngChunk::kChecksumBytes)) break;
        std::string text;
        if (chunk->type == "gAMA") text = gamma_text(bytes);
        if (chunk->type == "cHRM") text = chromaticities_text(bytes);
        if (chunk->type == "iCCP") text = profile_text(bytes);
        if (chunk->type == "sRGB") is_srgb = true;
        if (chunk->type == "cICP") is_srgb_for_certain = bytes == kSrgbCodePoints;
        if (chunk->type == "cICP" && !*is_srgb_for_certain) text = code_points_text(bytes);
        if (!text.empty()) found.push_back(text);
    }
    return is_srgb_for_certain.value_or(is_srgb) ? std::vector<std::string>{} : found;
}

bool have_same_picture_chunks(const std::string& path_a, const std::string& path_b) {
    if (!is_regular(path_a) || !is_regular(path_b)) return false;
    ByteReader a = ByteReader::of_file(path_a);
    ByteReader b = ByteReader::of_file(path_b);
    if (!are_equal(a, b, kPngSignature.size())) return false;
    for (;;) {
        const auto chunk = next_chunk_of_pixels(a);
        if (!chunk || chunk != next_chunk_of_pixels(b)) return false;
        if (!are_equal(a, b, chunk->length + PngChunk::kChecksumBytes)) return false;
        if (chunk->type == "IEND") return true;
    }
}

}  // namespace corda::media
