#include "corda/media/chunks/part_reader.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/image.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {

SoundBytes sound_bytes_of(const std::string& path, PartExtent extent) {
    const FileHandle file = open_for_reading(path);
    std::array<char, 1 << 16> block{};
    std::string ahead;  // bytes that are read and not yet counted
    std::uint64_t counted = 0;
    SoundBytes sound;
    PartChecksum checksum;
    const auto count = [&](std::size_t bytes) {
        checksum.add(std::string_view(ahead).substr(0, bytes));
        ahead.erase(0, bytes);
        counted += bytes;
    };
    while (extent == PartExtent::kAll || sound.count == 0) {
        const std::size_t at = ahead.find(PartChecksum::kMark);
        if (at != std::string::npos && at + PartChecksum::kRecordBytes <= ahead.size()) {
            count(at);
            sound.is_damaged = checksum.record() != ahead.substr(0, PartChecksum::kRecordBytes);
            if (sound.is_damaged) break;
            ahead.erase(0, PartChecksum::kRecordBytes);
            counted += PartChecksum::kRecordBytes;
            sound.count = counted;
            checksum = {};
            continue;
        }
        count(ahead.size() -
              std::min(ahead.size(), PartChecksum::kRecordBytes - 1));  // the rest may begin a record
        check_cancelled();
        const std::size_t read = read_bytes(file, path, block.data(), block.size());
        if (read == 0) break;
        ahead.append(block.data(), read);
    }
    return sound;
}

PartInput open_part(const std::string& path, std::uint64_t bytes) {
    PartInput input;
    AVFormatContext* format = nullptr;
    const std::string kind = file_kind(path);
    input.is_matroska = kind == "matroska";
    const AVInputFormat* demuxer = av_find_input_format(input.is_matroska ? "matroska" : "mov");
    check_libav(avformat_open_input(&format, file_url(path, bytes).c_str(), demuxer, nullptr),
                ExitCode::kMismatch, fmt::format("cannot read '{}' as a video", path),
                "it holds no picture that can be recovered");
    input.format.reset(format);
    const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    check_libav(index, ExitCode::kMismatch, fmt::format("no video in '{}'", path));
    input.stream = format->streams[index];
    const AVCodecParameters& parameters = *input.stream->codecpar;
    if (!is_picture_size(parameters.width, parameters.height))
        throw Error(ExitCode::kMismatch, fmt::format("'{}' is damaged: its frames would be {}x{} pixels",
                                                     path, parameters.width, parameters.height));
    if (const std::string problem = comment_problem(metadata_entry(*format, "comment")); !problem.empty())
        throw Error(ExitCode::kMismatch,
                    fmt::format("'{}' is damaged: its comment {}; render it again (--force)", path, problem));
    return input;
}

namespace {

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

/// The rate that the comment tells.
std::optional<Rational> told_rate_of(const PartInput& input) {
    return comment_rate(metadata_entry(*input.format, "comment"));
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

}  // namespace

PartIndex index_part(const std::string& path) {
    PartIndex index;
    const SoundBytes sound = sound_bytes_of(path, PartExtent::kAll);
    if (sound.count == 0 && file_size(path) == 0)
        throw EmptyPart(
            ExitCode::kMismatch,
            fmt::format("'{}' is empty: no chunk of it was finished; render it again (--force)", path));
    if (sound.count == 0)
        throw EmptyPart(ExitCode::kMismatch,
                        fmt::format("'{}' holds no whole chunk with a valid checksum; render it again "
                                    "(--force), or try to save what plays: ffmpeg -i '{}' -c copy NEW.mkv",
                                    path, path));
    index.bytes = sound.count;
    const PartInput input = open_part(path, index.bytes);
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    std::vector<std::int64_t> stamps;
    std::int64_t packet_duration = 0;
    index.codec = input.stream->codecpar->codec_id;
    bool has_bad_stamp = false;
    bool is_broken = false;
    while (read_packet(input, *packet, &is_broken)) {
        check_cancelled();
        has_bad_stamp = !is_sane_stamp(packet->pts);
        if (has_bad_stamp) break;
        packet_duration = packet->duration;
        stamps.push_back(packet->pts);
        av_packet_unref(packet.get());
    }
    if (stamps.empty()) {
        throw Error(ExitCode::kMismatch, fmt::format("'{}' holds no picture that can be recovered", path));
    }
    std::int64_t step = 0;
    index.fps = rate_of(path, input, packet_duration, stamps, step);
    if (index.fps.den > std::numeric_limits<int>::max()) fail_rate(path);  // more than libav can count
    number_frames(stamps, step, index);
    std::error_code ignored;
    index.is_damaged =
        sound.is_damaged || is_broken || has_bad_stamp || index.frame_of.size() < stamps.size();
    index.is_cut = index.bytes < std::filesystem::file_size(path, ignored);
    return index;
}

PartComment part_comment(const std::string& path) {
    const LogCapture log;
    const SoundBytes sound = sound_bytes_of(path, PartExtent::kFirstChunk);
    if (sound.count == 0) return {std::nullopt, sound.is_damaged};
    return {metadata_entry(*open_part(path, sound.count).format, "comment"), false};
}

bool holds_in_front(const std::string& path, std::string_view text) {
    const FileHandle file = open_for_reading(path);
    std::string front(std::size_t{1} << 18, '\0');
    front.resize(read_bytes(file, path, front.data(), front.size()));
    return front.find(text) != std::string::npos;
}

void remove_part_copy(const std::string& part) noexcept {
    try {
        const std::string copy = part_copy_path(part);
        std::error_code none;
        const bool is_empty = std::filesystem::file_size(copy, none) == 0;
        if (none) return;
        if (is_empty || holds_in_front(copy, fmt::format("\"{}\":", kOriginKey)))
            PartFile::remove_unheld(copy);
    } catch (const std::exception&) {
        return;
    }
}

void PacketCopy::copy_to(std::size_t end, TrackOutput& output) {
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    for (; next_ < end; ++next_) {
        if (!read_packet(*input_, *packet))
            throw Error(ExitCode::kIo, fmt::format("'{}' changed while it was read", *path_));
        check_cancelled();
        packet->pts = index_->frame_of[next_];
        packet->dts = static_cast<std::int64_t>(next_) - index_->reorder_depth;
        packet->duration = 1;
        output.write(*packet);
    }
}

}  // namespace corda::media
