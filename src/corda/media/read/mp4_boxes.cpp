#include <algorithm>
#include <string>
#include <string_view>

#include "corda/media/bytes.hpp"
#include "corda/media/read/containers.hpp"

namespace corda::media {
namespace {

constexpr std::uint64_t kMaxIndex = std::uint64_t{1} << 28;  // bytes; an index takes about 20 per frame
constexpr int kMaxBoxes = 10'000'000;                        // years of fragments

/// Calls visit(type, payload) for each box in `data`, up to the first that is not whole.
template <typename Visit>
void for_each_box(std::string_view data, const Visit& visit) {
    ByteReader bytes(data);
    for (auto box = next_mp4_box(bytes); box && box->length <= bytes.left(); box = next_mp4_box(bytes))
        visit(box->type, bytes.take(box->length));
}

/// A full box (ISO/IEC 14496-12, 4.2), whose version tells the size of its times. What is missing is 0.
struct FullBox {
    explicit FullBox(std::string_view payload) : bytes(payload), is_wide(bytes.number(1) == 1U) { skip(3); }

    void skip(std::uint64_t count) { static_cast<void>(bytes.skip(count)); }
    std::uint64_t number(std::size_t count) { return bytes.number(count).value_or(0); }
    /// A time or a duration.
    std::uint64_t time() { return number(time_bytes()); }
    [[nodiscard]] std::size_t time_bytes() const { return is_wide ? 8 : 4; }

    ByteReader bytes;
    bool is_wide;
};

/// Time scale and duration of an mvhd or mdhd box, which share their layout.
void read_clock(std::string_view payload, std::uint32_t& timescale, std::uint64_t& duration) {
    FullBox box(payload);
    box.skip(2 * box.time_bytes());
    timescale = static_cast<std::uint32_t>(box.number(4));
    duration = box.time();
}

void read_edits(std::string_view payload, std::vector<Mp4Edit>& edits) {
    FullBox box(payload);
    const std::uint64_t count = box.number(4);
    for (std::uint64_t i = 0; i < count && box.bytes.left() >= 2 * box.time_bytes() + 4; ++i) {
        const std::uint64_t duration = box.time();
        const std::uint64_t start = box.time();
        edits.push_back({duration, box.is_wide ? static_cast<std::int64_t>(start)
                                               : std::int64_t{static_cast<std::int32_t>(start)}});
        box.skip(4);
    }
}

void read_track(std::string_view track, Mp4Boxes& boxes) {
    for_each_box(track, [&](std::string_view type, std::string_view payload) {
        if (type == "tkhd") {
            FullBox box(payload);
            box.skip(2 * box.time_bytes() + 8);
            boxes.track_presentation = box.time();
        } else if (type == "mdia" || type == "edts") {
            for_each_box(payload, [&](std::string_view inner, std::string_view body) {
                if (inner == "mdhd") read_clock(body, boxes.track_timescale, boxes.track_duration);
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

}  // namespace

Mp4Boxes read_mp4_boxes(const std::string& path) {
    ByteReader bytes = ByteReader::of_file(path);
    Mp4Boxes boxes;
    boxes.file_bytes = bytes.left();
    bool saw_data = false;
    for (int i = 0; i < kMaxBoxes && bytes.left() > 0; ++i) {
        auto box = next_mp4_box(bytes);
        if (i == 0) boxes.is_mp4 = box && box->type == "ftyp";
        if (!box || !boxes.is_mp4) return boxes;
        if (box->type == "mdat") saw_data = true;
        if (box->type == "moof") boxes.fragmented = true;
        std::string payload;
        const bool is_index = box->type == "moov" && box->length <= kMaxIndex && !boxes.has_index;
        if (i == 0) payload = bytes.take(std::min<std::uint64_t>(box->length, 4));
        if (i == 0) boxes.is_quicktime = payload == "qt  ";
        if (box->length - payload.size() > bytes.left()) return boxes;
        if (is_index) {
            payload = bytes.take(box->length);
            boxes.index_first = !saw_data;
            read_index(payload, boxes);
        }
        if (!bytes.skip(box->length - payload.size())) return boxes;
    }
    boxes.whole = boxes.is_mp4 && bytes.left() == 0;
    return boxes;
}

}  // namespace corda::media
