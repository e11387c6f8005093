#include <cstdint>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>

#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/read/containers.hpp"

namespace corda::media {
namespace {

/// The bytes of a GIF's colour table (GIF89a, 18 and 20), of whose flags the last three bits are its size.
std::uint64_t color_table_bytes(std::uint64_t flags) {
    return (flags & 0x80U) != 0 ? std::uint64_t{3} << ((flags & 7U) + 1) : 0;
}

bool skip_sub_blocks(ByteReader& bytes) {
    for (;;) {
        const auto length = bytes.number(1);
        if (!length || !bytes.skip(*length)) return false;
        if (*length == 0) return true;
    }
}

bool gif_has_trailer(ByteReader& bytes) {
    if (!bytes.skip(10)) return false;  // signature and size
    const auto screen = bytes.number(1);
    if (!screen || !bytes.skip(2 + color_table_bytes(*screen))) return false;
    for (;;) {
        const auto block = bytes.number(1);
        if (block == 0x3bU) return true;
        if (block == 0U) continue;  // some writers leave one between blocks
        if (block == 0x21U) {       // an extension; its label comes first
            if (!bytes.skip(1) || !skip_sub_blocks(bytes)) return false;
        } else if (block == 0x2cU) {  // an image: place and size, colours, least code size
            if (!bytes.skip(8)) return false;
            const auto flags = bytes.number(1);
            if (!flags || !bytes.skip(color_table_bytes(*flags) + 1) || !skip_sub_blocks(bytes)) return false;
        } else {
            return false;
        }
    }
}

bool matroska_is_whole(ByteReader& bytes) {
    constexpr std::uint64_t kHeadId = 0x1a45dfa3;
    constexpr std::uint64_t kSegmentId = 0x18538067;
    if (bytes.number(4) != kHeadId) return false;
    const auto head = next_ebml_number(bytes);
    if (!head || head->is_unknown || !bytes.skip(head->length)) return false;
    const auto next = bytes.number(4);
    if (!next || *next != kSegmentId) return next.has_value();  // of another element, nothing is known
    const auto segment = next_ebml_number(bytes);
    return segment && (segment->is_unknown || bytes.skip(segment->length));
}

/// A line up to its end, which may be missing; empty after the last one.
std::string next_line(ByteReader& bytes) {
    constexpr std::size_t kLongest = 1024;
    std::string line;
    for (auto byte = bytes.number(1); byte && line.size() < kLongest; byte = bytes.number(1)) {
        line += static_cast<char>(*byte);
        if (*byte == '\n') break;
    }
    return line;
}

/// The bytes of a frame by a header such as "YUV4MPEG2 W640 H360 F60:1 C420mpeg2"; none if it has another
/// form.
std::optional<std::uint64_t> yuv_frame_bytes(const std::string& header) {
    std::uint64_t width = 0;
    std::uint64_t height = 0;
    std::string colors = "420";
    std::istringstream words(header);
    for (std::string word; words >> word;) {
        if (word[0] == 'W') width = std::strtoull(word.c_str() + 1, nullptr, 10);
        if (word[0] == 'H') height = std::strtoull(word.c_str() + 1, nullptr, 10);
        if (word[0] == 'C') colors = word.substr(1);
    }
    constexpr std::uint64_t kLargest = 1 << 20;
    if (width == 0 || height == 0 || width > kLargest || height > kLargest) return std::nullopt;
    if (colors == "444") return 3 * width * height;
    if (colors == "420" || colors == "420jpeg" || colors == "420mpeg2" || colors == "420paldv")
        return width * height + 2 * ((width + 1) / 2) * ((height + 1) / 2);
    return std::nullopt;
}

bool yuv_is_whole(ByteReader& bytes) {
    const auto frame = yuv_frame_bytes(next_line(bytes));
    if (!frame) return true;  // of other forms, nothing is known
    for (;;) {
        const std::string head = next_line(bytes);
        if (head.empty()) return true;
        if (!head.ends_with('\n') || !bytes.skip(*frame)) return false;
    }
}

}  // namespace

bool is_truncated(const std::string& path, const std::string& kind) {
    ByteReader bytes = ByteReader::of_file(path);
    if (kind == "gif") return !gif_has_trailer(bytes);
    if (kind == "matroska") return !matroska_is_whole(bytes);
    if (kind == "yuv4mpegpipe") return !yuv_is_whole(bytes);
    return false;
}

}  // namespace corda::media
