#include "corda/media/mp4_output.hpp"

#include <fmt/format.h>

#include <cassert>

#include "corda/core/error.hpp"

namespace corda::media {
namespace {

constexpr ExitCode kIo = ExitCode::kIo;

// delay_moov writes the header together with the first fragment, when it is known how far decoding runs
// ahead: without it the part file would start two frames late. Before the first fragment there is nothing to
// play anyway.
constexpr const char* kFragmentFlags = "frag_keyframe+empty_moov+default_base_moof+delay_moov";
constexpr const char* kFaststartFlags = "faststart";

}  // namespace

Mp4Output::Mp4Output(std::string path) : path_(std::move(path)) {
    const LogCapture log;
    AVIOContext* file = nullptr;
    check_libav(avio_open(&file, file_url(path_).c_str(), AVIO_FLAG_WRITE), kIo,
                fmt::format("cannot write '{}'", path_));
    file_.reset(file);
}

void Mp4Output::begin(Mp4Layout layout, const AVCodecParameters& parameters, Rational fps,
                      const std::string& title, const std::string& comment) {
    assert(!begun_);
    const LogCapture log;
    AVFormatContext* format = nullptr;
    check_libav(avformat_alloc_output_context2(&format, nullptr, "mp4", file_url(path_).c_str()), kIo,
                "cannot make an MP4 muxer");
    format_.reset(format);
    format_->pb = file_.get();
    // No library version and no date: the same input gives the same bytes.
    // The muxer must not move frame 0 away from 0; both layouts can say that decoding starts earlier.
    format_->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;
    format_->flags |= AVFMT_FLAG_BITEXACT | AVFMT_FLAG_FLUSH_PACKETS;
    if (!title.empty()) check_libav(av_dict_set(&format_->metadata, "title", title.c_str(), 0), kIo, "title");
    check_libav(av_dict_set(&format_->metadata, "comment", comment.c_str(), 0), kIo, "comment");

    AVStream* stream = check_allocated(avformat_new_stream(format_.get(), nullptr), "a video track");
    check_libav(avcodec_parameters_copy(stream->codecpar, &parameters), kIo, "cannot copy codec parameters");
    stream->codecpar->codec_tag = 0;  // the muxer chooses its own
    frame_base_ = frame_time_base(fps);
    stream->time_base = frame_base_;
    stream->avg_frame_rate = to_libav(fps);

    // Both clocks count in units of the rate's numerator, so that no stamp and no duration is ever rounded.
    Options options;
    options.set("movflags", layout == Mp4Layout::kFragmented ? kFragmentFlags : kFaststartFlags)
        .set("video_track_timescale", std::to_string(fps.num))
        .set("movie_timescale", std::to_string(fps.num));
    check_libav(avformat_write_header(format_.get(), options.get()), kIo,
                fmt::format("cannot write the MP4 header of '{}'", path_));
    if (const std::string name = options.left_over(); !name.empty()) {
        throw Error(ExitCode::kEncoder,
                    fmt::format("this libavformat has no MP4 option '{}'; FFmpeg 5.1 or newer has it", name));
    }
    begun_ = true;
}

void Mp4Output::write(AVPacket& packet) {
    assert(begun_);
    const LogCapture log;
    const AVStream* stream = format_->streams[0];
    av_packet_rescale_ts(&packet, frame_base_, stream->time_base);
    packet.stream_index = stream->index;
    packet.pos = -1;
    check_libav(av_write_frame(format_.get(), &packet), kIo, fmt::format("cannot write to '{}'", path_));
    av_packet_unref(&packet);
    check_libav(file_->error, kIo, fmt::format("cannot write to '{}'", path_));
}

void Mp4Output::close() {
    const LogCapture log;
    const std::string what = fmt::format("cannot finish '{}'", path_);
    if (begun_) {
        check_libav(av_write_trailer(format_.get()), kIo, what);
        check_libav(file_->error, kIo, what);
    }
    format_.reset();
    AVIOContext* file = file_.release();
    check_libav(avio_closep(&file), kIo, what);
}

}  // namespace corda::media
