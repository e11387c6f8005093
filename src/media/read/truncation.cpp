#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/read/containers.hpp"

namespace corda::media {
namespace {

/// Reads a file from its beginning. What is asked for behind its end is missing.
class ByteReader {
  public:
    explicit ByteReader(const std::string& path)
        : path_(path), file_(open_for_reading(path)), left_(file_size(path)) {}

    [[nodiscard]] std::optional<unsigned> next() {
        char byte = 0;
        if (read_bytes(file_, path_, &byte, 1) == 0) return std::nullopt;
        left_ -= left_ > 0 ? 1 : 0;
        return static_cast<unsigned char>(byte);
    }

    /// A number of some bytes, the largest first.
    [[nodiscard]] std::optional<std::uint64_t> number(int bytes) {
        std::uint64_t value = 0;
        for (int i = 0; i < bytes; ++i) {
            const auto byte = next();
            if (!byte) return std::nullopt;
            value = value << 8 | *byte;
        }
        return value;
    }

    /// Whether there are so many further bytes, which are left out.
    [[nodiscard]] bool skip(std::uint64_t count) {
        if (count > left_) return false;
        left_ -= count;
        std::array<char, 256> block{};  // of a GIF there are many, so that seeking would take long
        if (count <= block.size()) return read_bytes(file_, path_, block.data(), count) == count;
        return ::fseeko(file_.get(), static_cast<off_t>(count), SEEK_CUR) == 0;
    }

  private:
    std::string path_;
    FileHandle file_;
    std::uintmax_t left_;  ///< bytes to the end
};

/// The bytes of a GIF's colour table (GIF89a, 18 and 20), of whose flags the last three bits are its size.
std::uint64_t color_table_bytes(unsigned flags) {
    return (flags & 0x80U) != 0 ? std::uint64_t{3} << ((flags & 7U) + 1) : 0;
}

bool skip_sub_blocks(ByteReader& bytes) {
    for (;;) {
        const auto length = bytes.next();
        if (!length || !bytes.skip(*length)) return false;
        if (*length == 0) return true;
    }
}

bool gif_has_trailer(ByteReader& bytes) {
    if (!bytes.skip(10)) return false;  // signature and size
    const auto screen = bytes.next();
    if (!screen || !bytes.skip(2 + color_table_bytes(*screen))) return false;
    for (;;) {
        const auto block = bytes.next();
        if (block == 0x3bU) return true;
        if (block == 0U) continue;  // some writers leave one between blocks
        if (block == 0x21U) {       // an extension; its label comes first
            if (!bytes.skip(1) || !skip_sub_blocks(bytes)) return false;
        } else if (block == 0x2cU) {  // an image: place and size, colours, least code size
            if (!bytes.skip(8)) return false;
            const auto flags = bytes.next();
            if (!flags || !bytes.skip(color_table_bytes(*flags) + 1) || !skip_sub_blocks(bytes)) return false;
        } else {
            return false;
        }
    }
}

bool png_has_last_chunk(ByteReader& bytes) {
    if (!bytes.skip(8)) return false;  // signature
    for (;;) {
        const auto length = bytes.number(4);
        const auto name = bytes.number(4);
        if (!length || !name || !bytes.skip(*length + 4)) return false;
        if (*name == 0x49454e44U) return true;  // IEND
    }
}

/// A length in EBML (RFC 8794, 4), whose first set bit tells how many bytes it has; none if it is missing,
/// kUnknownLength if all bits are set.
constexpr std::uint64_t kUnknownLength = ~std::uint64_t{0};

std::optional<std::uint64_t> ebml_length(ByteReader& bytes) {
    const auto first = bytes.next();
    if (!first || *first == 0) return std::nullopt;
    int more = 0;
    while ((*first & (0x80U >> more)) == 0) ++more;
    const auto rest = bytes.number(more);
    if (!rest) return std::nullopt;
    const std::uint64_t value = (std::uint64_t{*first & (0x7fU >> more)} << (8 * more)) | *rest;
    return value + 1 == std::uint64_t{1} << (7 * (more + 1)) ? kUnknownLength : value;
}

bool matroska_is_whole(ByteReader& bytes) {
    constexpr std::uint64_t kHeadId = 0x1a45dfa3;
    constexpr std::uint64_t kSegmentId = 0x18538067;
    if (bytes.number(4) != kHeadId) return false;
    const auto head = ebml_length(bytes);
    if (!head || *head == kUnknownLength || !bytes.skip(*head)) return false;
    const auto next = bytes.number(4);
    if (!next || *next != kSegmentId) return next.has_value();  // of another element, nothing is known
    const auto segment = ebml_length(bytes);
    return segment && (*segment == kUnknownLength || bytes.skip(*segment));
}

/// A line up to its end, which may be missing; empty after the last one.
std::string next_line(ByteReader& bytes) {
    constexpr std::size_t kLongest = 1024;
    std::string line;
    for (auto byte = bytes.next(); byte && line.size() < kLongest; byte = bytes.next()) {
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
    ByteReader bytes(path);
    if (kind == "gif") return !gif_has_trailer(bytes);
    if (kind == "apng") return !png_has_last_chunk(bytes);
    if (kind == "matroska") return !matroska_is_whole(bytes);
    if (kind == "yuv4mpegpipe") return !yuv_is_whole(bytes);
    return false;
}

namespace {

constexpr std::int64_t kSignatureBytes = 8;
constexpr std::int64_t kChunkBytes = 12;  // length, name and checksum

}  // namespace

ApngTimes read_apng_times(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ApngTimes times;
    std::int64_t frames = 0;
    // The head of a chunk, and of an fcTL what is up to the delay's denominator, where 0 means 100.
    std::array<char, 32> head{};
    const std::string_view bytes(head.data(), head.size());
    const auto number = [bytes](std::size_t at, std::size_t count) {
        return static_cast<std::int64_t>(from_big_endian(bytes.substr(at, count)));
    };
    std::int64_t offset = kSignatureBytes;
    while (::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) == 0 &&
           read_bytes(file, path, head.data(), head.size()) == head.size()) {
        if (bytes.substr(4, 4) == "fcTL") {
            const std::int64_t den = number(30, 2);
            const Rational delay = Rational::reduced(number(28, 2), den == 0 ? 100 : den);
            if (frames == 0) times.delay_s = delay;
            if (delay != times.delay_s && times.uneven_at < 0) times.uneven_at = frames;
            ++frames;
        }
        offset += kChunkBytes + number(0, 4);
    }
    return times;
}

}  // namespace corda::media
