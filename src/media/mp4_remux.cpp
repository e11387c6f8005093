#include "corda/media/mp4_remux.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "corda/core/error.hpp"
#include "corda/media/file_ops.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/mp4_boxes.hpp"
#include "corda/media/mp4_output.hpp"
#include "corda/media/verify.hpp"

namespace corda::media {
namespace {

/// The part file, open for reading its packets.
struct PartInput {
    InputFormat format;
    const AVStream* stream = nullptr;
};

/// Opens the first `bytes` of a part: libav gives up on a file that ends in the middle of a fragment's
/// header.
PartInput open_part(const std::string& path, std::uint64_t bytes) {
    PartInput input;
    AVFormatContext* format = nullptr;
    const AVInputFormat* mov = av_find_input_format("mov");
    const std::string url = fmt::format("subfile,,start,0,end,{},,:{}", bytes, file_url(path));
    check_libav(avformat_open_input(&format, url.c_str(), mov, nullptr), ExitCode::kMismatch,
                fmt::format("cannot read '{}' as MP4", path), "it holds nothing that can be recovered");
    input.format.reset(format);
    const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    check_libav(index, ExitCode::kMismatch, fmt::format("no video in '{}'", path));
    input.stream = format->streams[index];
    return input;
}

/// Reads the next whole packet of the track; false at the end or where the file breaks off.
bool read_packet(const PartInput& input, AVPacket& packet) {
    while (av_read_frame(input.format.get(), &packet) >= 0) {
        const bool whole = (packet.flags & AV_PKT_FLAG_CORRUPT) == 0;
        if (whole && packet.stream_index == input.stream->index) return true;
        av_packet_unref(&packet);
        if (!whole) return false;
    }
    return false;
}

/// The order of the frames in a part: packet i, in decoding order, shows frame frame_of[i].
struct PartIndex {
    Rational fps;
    std::vector<std::int64_t> frame_of;
    std::int64_t reorder_depth = 0;  ///< how many frames decoding must run ahead of showing
    std::uint64_t bytes = 0;         ///< of the file that are whole
    bool truncated = false;
};

[[noreturn]] void fail_rate(const std::string& path) {
    throw Error(
        ExitCode::kMismatch,
        fmt::format("'{}' has no constant frame rate, so corda did not write it; use ffmpeg to convert it",
                    path));
}

/// Turns stamps (in units of the track's clock) into frame numbers, as far as they are complete: the longest
/// beginning in which each of 0 .. n-1 occurs once. It can be decoded, because everything it refers to comes
/// before.
void number_frames(const std::vector<std::int64_t>& stamps, std::int64_t step, PartIndex& index) {
    std::vector<bool> seen(stamps.size(), false);
    std::int64_t highest = -1;
    std::size_t complete = 0;
    std::int64_t depth = 0;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
        const std::int64_t frame = (stamps[i] - stamps.front()) / step;
        const auto slot = static_cast<std::size_t>(frame);
        if (slot >= seen.size() || seen[slot]) break;  // a negative number is a huge slot
        seen[slot] = true;
        index.frame_of.push_back(frame);
        highest = std::max(highest, frame);
        depth = std::max(depth, static_cast<std::int64_t>(i) - frame);
        if (highest != static_cast<std::int64_t>(i)) continue;
        complete = i + 1;
        index.reorder_depth = depth;
    }
    index.frame_of.resize(complete);
}

std::string metadata_entry(const AVFormatContext& format, const char* key) {
    const AVDictionaryEntry* entry = av_dict_get(format.metadata, key, nullptr, 0);
    return entry == nullptr ? std::string() : std::string(entry->value);
}

/// Ticks a frame: what all distances between stamps are multiples of. The duration of a packet is no guide,
/// libav guesses it at the end of a fragment; for a single frame the comment tells.
std::int64_t frame_step(const std::vector<std::int64_t>& stamps, const PartInput& input,
                        std::int64_t packet_duration) {
    std::int64_t step = 0;
    for (const std::int64_t stamp : stamps) step = std::gcd(step, stamp - stamps.front());
    if (step > 0) return step;
    const auto comment = nlohmann::json::parse(metadata_entry(*input.format, "comment"), nullptr, false);
    const auto fps = comment.is_object() && comment.contains("fps") && comment["fps"].is_string()
                         ? Rational::parse(comment["fps"].get<std::string>())
                         : std::nullopt;
    if (!fps || fps->num == 0) return packet_duration;
    return av_rescale_q(1, frame_time_base(*fps), input.stream->time_base);
}

PartIndex index_part(const std::string& path) {
    const Mp4Boxes boxes = read_mp4_boxes(path);
    PartIndex index;
    index.bytes = boxes.whole_bytes;
    const PartInput input = open_part(path, index.bytes);
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    std::vector<std::int64_t> stamps;
    std::int64_t packet_duration = 0;
    while (read_packet(input, *packet)) {
        if (packet->pts == AV_NOPTS_VALUE) fail_rate(path);
        packet_duration = packet->duration;
        stamps.push_back(packet->pts);
        av_packet_unref(packet.get());
    }
    if (stamps.empty()) {
        throw Error(ExitCode::kMismatch,
                    fmt::format("'{}' holds no whole fragment; nothing can be recovered", path));
    }
    const std::int64_t step = frame_step(stamps, input, packet_duration);
    if (step <= 0) fail_rate(path);
    number_frames(stamps, step, index);
    index.fps = Rational::reduced(input.stream->time_base.den, input.stream->time_base.num * step);
    index.truncated = boxes.whole_bytes < boxes.file_bytes || index.frame_of.size() < stamps.size();
    return index;
}

std::string comment_with_frames(const std::string& comment, std::size_t frames) {
    auto json = nlohmann::json::parse(comment, nullptr, false);
    if (!json.is_object()) return comment;
    json["frames"] = frames;
    return json.dump();
}

void copy_packets(const PartInput& input, const PartIndex& index, Mp4Output& output,
                  const std::string& path) {
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    for (std::size_t i = 0; i < index.frame_of.size(); ++i) {
        if (!read_packet(input, *packet)) {
            throw Error(ExitCode::kIo, fmt::format("'{}' changed while it was read", path));
        }
        packet->pts = index.frame_of[i];
        packet->dts = static_cast<std::int64_t>(i) - index.reorder_depth;
        packet->duration = 1;
        output.write(*packet);
    }
}

std::string listed(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += "\n  - " + line;
    return text;
}

}  // namespace

RemuxResult remux_part(const std::string& part_path, const std::string& out_path) {
    const LogCapture log;
    const PartIndex index = index_part(part_path);
    const PartInput input = open_part(part_path, index.bytes);
    const std::string comment = metadata_entry(*input.format, "comment");
    try {
        Mp4Output output(out_path);
        output.begin(Mp4Layout::kFaststart, *input.stream->codecpar, index.fps,
                     metadata_entry(*input.format, "title"),
                     comment_with_frames(comment, index.frame_of.size()));
        copy_packets(input, index, output, part_path);
        output.close();
    } catch (...) {
        remove_quietly(out_path);
        throw;
    }
    return {static_cast<std::int64_t>(index.frame_of.size()), index.truncated};
}

RemuxResult recover_part(const std::string& part_path, const std::string& path,
                         std::optional<std::int64_t> expected_frames) {
    const std::string temporary = path + ".tmp";
    const RemuxResult result = remux_part(part_path, temporary);
    try {
        if (expected_frames && *expected_frames != result.frames) {
            throw Error(ExitCode::kMismatch,
                        fmt::format("'{}' holds {} frames instead of {}; it stays as it is", part_path,
                                    result.frames, *expected_frames));
        }
        const VerifyReport report = verify(temporary);
        if (!report.ok()) {
            throw Error(ExitCode::kMismatch,
                        fmt::format("the video for '{}' failed its check and stays as '{}':{}", path,
                                    part_path, listed(report.problems)));
        }
        sync_file(temporary);
        rename_file(temporary, path);
    } catch (...) {
        remove_quietly(temporary);
        throw;
    }
    sync_folder_of(path);
    remove_quietly(part_path);
    return result;
}

}  // namespace corda::media
