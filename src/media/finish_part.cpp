#include "corda/media/finish_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/animation.hpp"
#include "corda/media/checked.hpp"
#include "corda/media/file_kind.hpp"
#include "corda/media/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/mp4_boxes.hpp"
#include "corda/media/open_video.hpp"
#include "corda/media/track_output.hpp"
#include "corda/media/verify.hpp"
#include "corda/media/video_comment.hpp"

namespace corda::media {
namespace {

/// The part file, open for reading its packets.
struct PartInput {
    InputFormat format;
    const AVStream* stream = nullptr;
    bool is_matroska = false;  ///< then stamps are rounded to milliseconds
};

/// Opens the first `bytes` of a part: libav gives up on a file that ends in the middle of a fragment's
/// header.
PartInput open_part(const std::string& path, std::uint64_t bytes) {
    PartInput input;
    AVFormatContext* format = nullptr;
    const std::string kind = file_kind(path);
    input.is_matroska = kind == "matroska";
    const AVInputFormat* demuxer = av_find_input_format(input.is_matroska ? "matroska" : "mov");
    const std::string url = fmt::format("subfile,,start,0,end,{},,:{}", bytes, file_url(path));
    check_libav(avformat_open_input(&format, url.c_str(), demuxer, nullptr), ExitCode::kMismatch,
                fmt::format("cannot read '{}' as a video", path),
                "it holds no picture that can be recovered");
    input.format.reset(format);
    const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    check_libav(index, ExitCode::kMismatch, fmt::format("no video in '{}'", path));
    input.stream = format->streams[index];
    return input;
}

/// Reads the next whole packet of the track; false at the end and at the point where the file breaks off.
bool read_packet(const PartInput& input, AVPacket& packet, bool* is_broken = nullptr) {
    for (;;) {
        const int status = av_read_frame(input.format.get(), &packet);
        if (status < 0) {
            if (is_broken != nullptr) *is_broken = status != AVERROR_EOF;
            return false;
        }
        const bool whole = (packet.flags & AV_PKT_FLAG_CORRUPT) == 0;
        if (whole && packet.stream_index == input.stream->index) return true;
        av_packet_unref(&packet);
        if (!whole) {
            if (is_broken != nullptr) *is_broken = true;
            return false;
        }
    }
}

/// The order of the frames in a part: packet i, in decoding order, shows frame frame_of[i].
struct PartIndex {
    Rational fps;
    std::vector<std::int64_t> frame_of;
    std::int64_t reorder_depth = 0;  ///< how many frames decoding must run ahead of showing
    AVCodecID codec = AV_CODEC_ID_NONE;
    std::uint64_t bytes = 0;  ///< length of the beginning that is whole
    bool truncated = false;
};

[[noreturn]] void fail_rate(const std::string& path) {
    throw Error(
        ExitCode::kMismatch,
        fmt::format("'{}' has no constant frame rate, so corda did not write it; use ffmpeg to convert it",
                    path));
}

/// Turns stamps (in ticks of the track) into frame numbers, for the longest beginning in which each of 0 ..
/// n-1 occurs once. This beginning can be decoded, because packets refer only to earlier ones.
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

/// The rate that the comment tells.
std::optional<Rational> told_rate_of(const PartInput& input) {
    return told_rate(metadata_entry(*input.format, "comment"));
}

/// Ticks per frame: the greatest common divisor of all distances between stamps. The duration of a packet is
/// no guide, because libav guesses it at the end of a fragment; for a single frame the comment tells.
std::int64_t frame_step(const std::vector<std::int64_t>& stamps, const PartInput& input,
                        std::int64_t packet_duration) {
    std::int64_t step = 0;
    for (const std::int64_t stamp : stamps) step = std::gcd(step, stamp - stamps.front());
    if (step > 0) return step;
    const auto fps = told_rate_of(input);
    return fps ? av_rescale_q(1, frame_time_base(*fps), input.stream->time_base) : packet_duration;
}

/// The rate of the frames with these stamps, which become numbers of frames if they were rounded.
Rational rate_of(const std::string& path, const PartInput& input, std::int64_t packet_duration,
                 std::vector<std::int64_t>& stamps, std::int64_t& step) {
    if (input.is_matroska) {
        const auto fps = told_rate_of(input);
        if (!fps) fail_rate(path);
        for (std::int64_t& stamp : stamps)
            stamp = av_rescale_q(stamp, input.stream->time_base, frame_time_base(*fps));
        step = 1;
        return *fps;
    }
    step = frame_step(stamps, input, packet_duration);
    const auto duration = checked_multiply(step, std::int64_t{input.stream->time_base.num});
    if (!duration || *duration <= 0) fail_rate(path);
    return Rational::reduced(input.stream->time_base.den, *duration);
}

PartIndex index_part(const std::string& path, const OnProgress& on_progress) {
    const Mp4Boxes boxes = read_mp4_boxes(path);
    PartIndex index;
    index.bytes = boxes.is_mp4 ? boxes.whole_bytes : boxes.file_bytes;
    const PartInput input = open_part(path, index.bytes);
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    std::vector<std::int64_t> stamps;
    std::int64_t packet_duration = 0;
    index.codec = input.stream->codecpar->codec_id;
    bool is_damaged = false;
    bool is_broken = false;
    while (read_packet(input, *packet, &is_broken)) {
        report_progress(on_progress, std::ssize(stamps), 0);
        is_damaged = !is_sane_stamp(packet->pts);
        if (is_damaged) break;
        packet_duration = packet->duration;
        stamps.push_back(packet->pts);
        av_packet_unref(packet.get());
    }
    if (stamps.empty()) {
        throw Error(ExitCode::kMismatch,
                    fmt::format("'{}' holds no whole fragment, so no frame can be recovered", path));
    }
    std::int64_t step = 0;
    index.fps = rate_of(path, input, packet_duration, stamps, step);
    if (index.fps.den > std::numeric_limits<int>::max()) fail_rate(path);  // more than libav can count
    number_frames(stamps, step, index);
    index.truncated = index.bytes < boxes.file_bytes || is_damaged || index.frame_of.size() < stamps.size();
    return index;
}

void copy_packets(const PartInput& input, const PartIndex& index, TrackOutput& output,
                  const std::string& path, const OnProgress& on_progress) {
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    for (std::size_t i = 0; i < index.frame_of.size(); ++i) {
        if (!read_packet(input, *packet)) {
            throw Error(ExitCode::kIo, fmt::format("'{}' changed while it was read", path));
        }
        report_progress(on_progress, static_cast<std::int64_t>(i), std::ssize(index.frame_of));
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

/// Copies the indexed packets into `output`, with time stamps made anew from frame numbers and the frame
/// count in the comment.
void remux(const PartIndex& index, const std::string& part_path, const Ending& ending,
           const OnProgress& on_progress, OutputFile& output) {
    const PartInput input = open_part(part_path, index.bytes);
    TrackOutput track(output.descriptor(), output.temporary_path());
    track.begin(
        ending.muxer, TrackLayout::kFinal, *input.stream->codecpar,
        {.fps = index.fps,
         .title = metadata_entry(*input.format, "title"),
         .comment = comment_with_frames(metadata_entry(*input.format, "comment"), index.frame_of.size()),
         .has_alpha = is_marked_as_alpha(*input.stream)});
    copy_packets(input, index, track, part_path, on_progress);
    track.finish();
}

/// A part can become what its codec goes into.
void check_ending(const PartIndex& index, const std::string& part_path, const std::string& path,
                  const Ending& ending) {
    for (const char* const name : ending.codecs) {
        const AVCodec* const codec = name == nullptr ? nullptr : avcodec_find_encoder_by_name(name);
        const bool is_file = ending.kind == FileKind::kVideo || ending.kind == FileKind::kAnimation;
        if (is_file && codec != nullptr && codec->id == index.codec) return;
    }
    throw Error(
        ExitCode::kUsage,
        fmt::format("'{}' holds {}, which '{}' cannot be made of; give the ending that the render was for",
                    part_path, avcodec_get_name(index.codec), path));
}

/// What an animation shows that cannot tell what it was rendered as.
void check_animation(const PartIndex& index, const Ending& ending, VerifyReport& report) {
    if (ending.kind != FileKind::kAnimation || !report.ok()) return;
    const auto frames = std::ssize(index.frame_of);
    if (report.frames != frames)
        report.problems.push_back(
            fmt::format("{} frames were rendered but {} decode", frames, report.frames));
    if (report.fps != index.fps)
        report.problems.push_back(fmt::format("it was rendered for {} fps but plays at {} fps",
                                              index.fps.text(), report.fps.text()));
}

}  // namespace

RemuxResult finish_part(PartFile& part, const std::string& path, const OutputOptions& options,
                        std::optional<std::int64_t> expected_frames, VerifyDepth depth) {
    const LogCapture log;
    const OnProgress all_done = [&options, frames = expected_frames.value_or(0)](std::int64_t, std::int64_t) {
        return !options.on_progress || options.on_progress(frames, frames);
    };
    const PartIndex index = index_part(part.path(), all_done);
    const RemuxResult result{static_cast<std::int64_t>(index.frame_of.size()), index.truncated};
    if (expected_frames && *expected_frames != result.frames) {
        throw Error(ExitCode::kMismatch, fmt::format("'{}' holds {} frames instead of {}; it stays as it is",
                                                     part.path(), result.frames, *expected_frames));
    }
    const Ending& ending = find_ending(path);
    check_ending(index, part.path(), path, ending);
    OutputFile output(path, options);
    if (ending.kind == FileKind::kAnimation)
        write_animation(part.path(), ending, index.fps, result.frames, all_done, output);
    else
        remux(index, part.path(), ending, all_done, output);
    VerifyReport report = verify(output.temporary_path(), all_done, depth);
    check_animation(index, ending, report);
    if (!report.ok()) {
        throw Error(ExitCode::kMismatch,
                    fmt::format("the video for '{}' failed its check and stays as '{}':{}", path, part.path(),
                                listed(report.problems)));
    }
    output.commit();
    part.remove();
    return result;
}

RemuxResult recover_part(const std::string& part_path, const std::string& path,
                         const OutputOptions& options) {
    PartFile part = PartFile::open(part_path);
    return finish_part(part, path, options);
}

}  // namespace corda::media
