#include "corda/media/write/track_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"

namespace corda::media {
namespace {

constexpr ExitCode kIo = ExitCode::kIo;

constexpr int kBufferBytes = 1 << 16;

void set(AVDictionary*& dictionary, const char* key, const std::string& value) {
    check_libav(av_dict_set(&dictionary, key, value.c_str(), 0), kIo, key);
}

/// The four characters that name the codec in the file; 0: the muxer's choice.
std::uint32_t tag_of(const AVCodecParameters& parameters) {
    if (parameters.codec_id == AV_CODEC_ID_HEVC) return MKTAG('h', 'v', 'c', '1');  // Apple's players want it
    return parameters.codec_id == AV_CODEC_ID_PRORES ? parameters.codec_tag : 0;    // it tells the profile
}

/// The muxer's options.
void set_options(std::string_view container, const TrackInfo& info, Options& options) {
    const Rational fps = info.fps;
    if (container == "mp4" || container == "mov") {
        // Both clocks count in units of the rate's numerator, so that no stamp and no duration is ever
        // rounded.
        options.set("movflags", "faststart")
            .set("video_track_timescale", std::to_string(fps.num))
            .set("movie_timescale", std::to_string(fps.num));
    } else if (container == "matroska" || container == "webm") {
        options.set("cues_to_front", "1");
    } else if (container == "gif") {
        // Each frame ends at the hundredth that is the nearest to its time, so that delays add up exactly.
        const auto end = [fps](std::int64_t frames) { return av_rescale(100 * frames, fps.den, fps.num); };
        // The muxer counts repetitions, -1 for none.
        options.set("loop", std::to_string(info.loop == 0   ? 0
                                           : info.loop == 1 ? -1
                                                            : info.loop - 1))
            .set("final_delay", std::to_string(end(info.frames) - end(info.frames - 1)));
    }
}

}  // namespace

int TrackOutput::write_bytes(void* output, const std::uint8_t* bytes, int count) {
    TrackOutput& track = *static_cast<TrackOutput*>(output);
    const std::string_view data(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count));
    const CancelScope uncancelled({}, CancelScope::Outer::kIgnored);  // libav is between here and the caller
    const int status = write_all(track.descriptor_, data);
    return status != 0 ? AVERROR(status) : count;
}

std::int64_t TrackOutput::seek(void* output, std::int64_t offset, int whence) {
    if (whence == AVSEEK_SIZE) return AVERROR(ENOSYS);
    const int descriptor = static_cast<const TrackOutput*>(output)->descriptor_;
    const off_t position = ::lseek(descriptor, offset, whence & ~AVSEEK_FORCE);
    return position < 0 ? AVERROR(errno) : position;
}

TrackOutput::~TrackOutput() {
    // The muxer of GIF keeps a packet until its trailer, and loses it without.
    const bool holds_packet = !ended_ && std::string_view(format_->oformat->name) == "gif";
    if (holds_packet) static_cast<void>(av_write_trailer(format_.get()));
}

TrackOutput::TrackOutput(const OutputFile& output, const char* container, const AVCodecParameters& parameters,
                         const TrackInfo& info)
    : descriptor_(output.descriptor()), path_(output.temporary_path()) {
    const LogCapture log;
    auto* buffer = static_cast<unsigned char*>(av_malloc(kBufferBytes));
    // FFmpeg 7.0 makes the bytes const: `auto` becomes either type.
    const auto write = [](void* track, auto* bytes, int count) { return write_bytes(track, bytes, count); };
    if (buffer != nullptr)
        io_.reset(avio_alloc_context(buffer, kBufferBytes, 1, this, nullptr, write, &seek));
    io_ = check_allocated(std::move(io_), "an output buffer");
    AVFormatContext* format = nullptr;
    check_libav(avformat_alloc_output_context2(&format, nullptr, container, file_url(path_).c_str()), kIo,
                fmt::format("this libavformat does not write {}", container));
    format_.reset(format);
    format_->pb = io_.get();
    // No library version and no date: the same input gives the same bytes.
    // The muxer must not move frame 0 away from 0; a file can say that decoding starts earlier.
    format_->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;
    format_->flags |= AVFMT_FLAG_BITEXACT | AVFMT_FLAG_FLUSH_PACKETS;
    if (!info.title.empty()) set(format_->metadata, "title", info.title);
    set(format_->metadata, "comment", info.comment);

    AVStream* stream = check_allocated(avformat_new_stream(format_.get(), nullptr), "a video track");
    check_libav(avcodec_parameters_copy(stream->codecpar, &parameters), kIo, "cannot copy codec parameters");
    stream->codecpar->codec_tag = tag_of(parameters);
    if (info.has_alpha) set(stream->metadata, "alpha_mode", "1");
    frame_base_ = frame_time_base(info.fps);
    stream->time_base = frame_base_;
    stream->avg_frame_rate = to_libav(info.fps);

    Options options;
    set_options(container, info, options);
    check_libav(avformat_write_header(format_.get(), options.get()), kIo,
                fmt::format("cannot write the header of '{}'", path_));
    if (const std::string name = options.left_over(); !name.empty()) {
        throw_error(ExitCode::kEncoder,
                    "this libavformat has no option '{}' of {}; FFmpeg 5.1 or newer has it", name, container);
    }
}

void TrackOutput::write(AVPacket& packet) {
    const LogCapture log;
    const AVStream* stream = format_->streams[0];
    av_packet_rescale_ts(&packet, frame_base_, stream->time_base);
    packet.stream_index = stream->index;
    packet.pos = -1;
    bytes_ += packet.size;
    ++frames_;
    check_libav(av_write_frame(format_.get(), &packet), kIo, fmt::format("cannot write to '{}'", path_));
    av_packet_unref(&packet);
    check_libav(io_->error, kIo, fmt::format("cannot write to '{}'", path_));
}

void TrackOutput::finish() {
    const LogCapture log;
    const std::string what = fmt::format("cannot finish '{}'", path_);
    ended_ = true;
    // Of the whole video: MP4 states it as the largest bit rate, if the average is not larger.
    format_->streams[0]->codecpar->bit_rate =
        av_rescale(bytes_, 8 * std::int64_t{frame_base_.den}, frames_ * frame_base_.num);
    check_libav(av_write_trailer(format_.get()), kIo, what);
    avio_flush(io_.get());
    check_libav(io_->error, kIo, what);
}

}  // namespace corda::media
