#include "corda/media/read/containers.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <optional>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/media/bytes.hpp"

namespace corda::media {
namespace {

constexpr std::uint64_t kMaxIndex = std::uint64_t{1} << 28;  // bytes; an index takes about 20 per frame
constexpr int kMaxBoxes = 10'000'000;                        // years of fragments

/// Big-endian numbers of a byte range; reading past its end gives 0.
class Bytes {
  public:
    explicit Bytes(std::string_view data) : data_(data) {}

    [[nodiscard]] std::uint64_t number(std::size_t offset, std::size_t width) const {
        if (offset > data_.size() || data_.size() - offset < width) return 0;
        return from_big_endian(data_.substr(offset, width));
    }
    [[nodiscard]] std::uint32_t u32(std::size_t offset) const {
        return static_cast<std::uint32_t>(number(offset, 4));
    }
    [[nodiscard]] std::string_view sub(std::size_t offset, std::size_t size) const {
        return data_.substr(offset, size);
    }
    [[nodiscard]] std::size_t size() const { return data_.size(); }

  private:
    std::string_view data_;
};

/// Calls visit(type, payload) for each box in `data`, up to the first that is not whole.
template <typename Visit>
void for_each_box(std::string_view data, Visit visit) {
    const Bytes bytes(data);
    std::size_t offset = 0;
    while (bytes.size() - offset >= 8) {
        std::uint64_t size = bytes.u32(offset);
        std::size_t header = 8;
        if (size == 1 && bytes.size() - offset >= 16) {
            size = bytes.number(offset + 8, 8);
            header = 16;
        }
        if (size == 0) size = bytes.size() - offset;
        if (size < header || size > bytes.size() - offset) return;
        visit(bytes.sub(offset + 4, 4), bytes.sub(offset + header, static_cast<std::size_t>(size) - header));
        offset += static_cast<std::size_t>(size);
    }
}

/// Time scale and duration of an mvhd or mdhd box, which share their layout.
void read_clock(std::string_view payload, std::uint32_t& timescale, std::uint64_t& duration) {
    const Bytes bytes(payload);
    const bool wide = bytes.number(0, 1) == 1;
    timescale = bytes.u32(wide ? 20 : 12);
    duration = wide ? bytes.number(24, 8) : bytes.u32(16);
}

void read_edits(std::string_view payload, std::vector<Mp4Edit>& edits) {
    const Bytes bytes(payload);
    const bool wide = bytes.number(0, 1) == 1;
    const std::size_t entry = wide ? 20 : 12;
    const std::size_t count = bytes.u32(4);
    for (std::size_t i = 0; i < count && 8 + (i + 1) * entry <= bytes.size(); ++i) {
        const std::size_t at = 8 + i * entry;
        const auto time = wide ? static_cast<std::int64_t>(bytes.number(at + 8, 8))
                               : std::int64_t{static_cast<std::int32_t>(bytes.u32(at + 4))};
        edits.push_back({wide ? bytes.number(at, 8) : bytes.u32(at), time});
    }
}

void read_track(std::string_view track, Mp4Boxes& boxes) {
    for_each_box(track, [&](std::string_view type, std::string_view payload) {
        if (type == "tkhd") {
            const Bytes bytes(payload);
            const bool wide = bytes.number(0, 1) == 1;
            boxes.track_presentation = wide ? bytes.number(28, 8) : bytes.u32(20);
        } else if (type == "mdia") {
            for_each_box(payload, [&](std::string_view inner, std::string_view body) {
                if (inner == "mdhd") read_clock(body, boxes.track_timescale, boxes.track_duration);
            });
        } else if (type == "edts") {
            for_each_box(payload, [&](std::string_view inner, std::string_view body) {
                if (inner == "elst") read_edits(body, boxes.edits);
            });
        }
    });
}

void read_index(std::string_view index, Mp4Boxes& boxes) {
    for_each_box(index, [&](std::string_view type, std::string_view payload) {
        if (type == "mvhd") read_clock(payload, boxes.movie_timescale, boxes.movie_duration);
        if (type == "mvex") boxes.fragmented = true;
        if (type == "trak" && ++boxes.tracks == 1) read_track(payload, boxes);
    });
    boxes.has_index = boxes.tracks > 0;
}

struct BoxHeader {
    std::string type;
    std::uint64_t size = 0;  ///< including the header; up to the end of the file if the box says 0
    std::uint64_t header_size = 8;
};

/// Up to `count` bytes of a file; fewer at its end.
std::string read_range(const FileHandle& file, const std::string& path, std::uint64_t offset,
                       std::uint64_t size) {
    if (::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) != 0) fail_file("read", path, errno);
    std::string data(static_cast<std::size_t>(size), '\0');
    data.resize(read_bytes(file, path, data.data(), data.size()));
    return data;
}

std::optional<BoxHeader> header_in(const std::string& raw, std::uint64_t left_in_file) {
    const Bytes bytes(raw);
    if (raw.size() < 8) return std::nullopt;
    BoxHeader header{std::string(bytes.sub(4, 4)), bytes.u32(0), 8};
    if (header.size == 1) {
        header.size = bytes.number(8, 8);
        header.header_size = 16;
    }
    if (header.size == 0) header.size = left_in_file;
    if (header.size < header.header_size) return std::nullopt;
    return header;
}

}  // namespace

Mp4Boxes read_mp4_boxes(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    struct stat status {};
    if (::fstat(::fileno(file.get()), &status) != 0) fail_file("read", path, errno);
    const auto file_size = static_cast<std::uint64_t>(status.st_size);
    Mp4Boxes boxes;
    boxes.file_bytes = file_size;
    bool saw_data = false;
    std::uint64_t offset = 0;
    for (int i = 0; i < kMaxBoxes && offset < file_size; ++i) {
        const auto header = header_in(read_range(file, path, offset, 16), file_size - offset);
        if (!header) break;
        if (i == 0) boxes.is_mp4 = header->type == "ftyp";
        if (!boxes.is_mp4) break;
        if (i == 0) boxes.is_quicktime = read_range(file, path, offset + header->header_size, 4) == "qt  ";
        if (header->type == "mdat") saw_data = true;
        if (header->type == "moof") boxes.fragmented = true;
        if (header->size > file_size - offset) break;
        if (header->type == "moov" && header->size <= kMaxIndex && !boxes.has_index) {
            boxes.index_first = !saw_data;
            read_index(
                read_range(file, path, offset + header->header_size, header->size - header->header_size),
                boxes);
        }
        offset += header->size;
    }
    boxes.whole = boxes.is_mp4 && offset == file_size;
    return boxes;
}

}  // namespace corda::media
