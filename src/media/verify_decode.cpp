#include "corda/media/verify_decode.hpp"

#include <algorithm>
#include <functional>
#include <queue>

#include "corda/core/basics.hpp"
#include "corda/media/checked.hpp"
#include "corda/media/color_patch.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/open_mp4.hpp"

namespace corda::media {
namespace {

std::string named(const char* name) {
    return name == nullptr ? "unknown" : name;
}

/// Mean of the samples in a square of an 8-bit plane.
double plane_mean(const AVFrame& frame, int plane, int x, int y, int side) {
    std::int64_t sum = 0;
    for (int row = y; row < y + side; ++row) {
        const std::uint8_t* line = frame.data[plane] + std::ptrdiff_t{row} * frame.linesize[plane];
        for (int column = x; column < x + side; ++column) sum += line[column];
    }
    return static_cast<double>(sum) / (side * side);
}

/// Decodes one file and fills in a DecodedVideo.
class Decoding {
  public:
    Decoding(DecodedVideo& video, VerifyDepth depth,
             std::vector<ColorPatch> (*patches_of)(const std::string&))
        : video_(video), depth_(depth), patches_of_(patches_of) {}

    void run(const std::string& path, const OnProgress& on_progress) {
        if (!open(path)) return;
        video_.opened = true;
        while (read_packet()) report_progress(on_progress, video_.frames, 0);
        if (depth_ == VerifyDepth::kAllFrames)
            receive(nullptr);
        else
            take_stamps(0);
        // libav guesses the duration of the last frame; check_clocks in verify.cpp compares the end with the
        // track's stored duration.
        if (video_.frames == 1)
            video_.step =
                is_sane_stamp(file_.stream->duration) ? std::max<std::int64_t>(file_.stream->duration, 0) : 0;
        video_.end = last_pts_ + video_.step;
        describe();
    }

  private:
    bool open(const std::string& path) {
        try {
            file_ = open_mp4(path);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo) throw;
            video_.open_reason = error.what();
            return false;
        }
        frame_ = check_allocated(Frame(av_frame_alloc()), "a frame");
        packet_ = check_allocated(Packet(av_packet_alloc()), "a packet");
        const AVCodecParameters& parameters = *file_.stream->codecpar;
        video_.container_tags = named(av_color_range_name(parameters.color_range)) + " " +
                                named(av_color_space_name(parameters.color_space)) + " " +
                                named(av_color_primaries_name(parameters.color_primaries)) + " " +
                                named(av_color_transfer_name(parameters.color_trc));
        const AVDictionaryEntry* comment = av_dict_get(file_.format->metadata, "comment", nullptr, 0);
        if (comment != nullptr) video_.comment = comment->value;
        video_.tick = {file_.stream->time_base.num, file_.stream->time_base.den};
        return true;
    }

    void note_bad(int status) {
        if (status == AVERROR(ENOMEM) || *file_.lacks_memory)
            fail_libav(ExitCode::kTemporary, "decoding", AVERROR(ENOMEM));
        note_bad(log_.text().empty() ? libav_text(status) : log_.text());
    }

    void note_bad(const std::string& reason) {
        if (video_.bad_frames++ == 0) video_.bad_reason = reason;
    }

    bool read_packet() {
        log_.clear();
        const int status = av_read_frame(file_.format.get(), packet_.get());
        if (status < 0) {
            if (status != AVERROR_EOF) note_bad(status);
            return false;
        }
        if (packet_->stream_index == file_.stream->index) {
            if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0) note_bad(AVERROR_INVALIDDATA);
            if (depth_ == VerifyDepth::kAllFrames)
                receive(packet_.get());
            else
                read_alone(*packet_);
        }
        av_packet_unref(packet_.get());
        return true;
    }

    /// Decodes a packet of a key frame, apart from all others, and notes the stamp of any packet.
    void read_alone(const AVPacket& packet) {
        if ((packet.flags & AV_PKT_FLAG_KEY) != 0) {
            receive(&packet);
            receive(nullptr);
            avcodec_flush_buffers(file_.context.get());
        }
        stamps_.push(packet.pts);
        take_stamps(kMostReordered);
    }

    /// Takes the stamps of packets in the order in which their frames are shown, but for so many.
    void take_stamps(std::size_t kept) {
        for (; stamps_.size() > kept; stamps_.pop()) take_stamp(stamps_.top());
    }

    /// Sends a packet, or the end of the stream if it is null, and takes every frame that is ready.
    void receive(const AVPacket* packet) {
        int status = avcodec_send_packet(file_.context.get(), packet);
        if (status < 0) note_bad(status);
        for (;;) {
            status = avcodec_receive_frame(file_.context.get(), frame_.get());
            if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
            if (status < 0) {
                note_bad(status);
                // While draining, libav reports one error per bad frame and goes on; otherwise the next
                // packet is due.
                if (packet != nullptr || video_.bad_frames > kMostBadFrames) return;
                continue;
            }
            take_frame();
            av_frame_unref(frame_.get());
        }
    }

    void take_frame() {
        const AVFrame& frame = *frame_;
        if (frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0)
            note_bad(AVERROR_INVALIDDATA);
        if (!is_described_) measure_patches();
        // Only the first frame's pixels are measured; for the others it is enough that they decode.
        file_.context->skip_loop_filter = AVDISCARD_ALL;
        if (depth_ == VerifyDepth::kAllFrames) take_stamp(frame.pts);
    }

    void take_stamp(std::int64_t pts) {
        if (!is_sane_stamp(pts)) {
            note_bad(pts == AV_NOPTS_VALUE ? "a frame has no time stamp"
                                           : "a frame has the time stamp " + std::to_string(pts));
            return;
        }
        if (video_.frames == 0) {
            video_.first_pts = pts;
        } else {
            if (video_.frames == 1) video_.step = pts - last_pts_;
            if (pts - last_pts_ != video_.step && video_.uneven_at < 0) video_.uneven_at = video_.frames;
        }
        last_pts_ = pts;
        ++video_.frames;
    }

    void measure_patches() {
        is_described_ = true;
        describe_first_frame();
        if (frame_->format != AV_PIX_FMT_YUV420P && frame_->format != AV_PIX_FMT_YUVJ420P) return;
        for (const ColorPatch& patch : patches_of_(video_.comment)) {
            const bool inside = patch.x >= 0 && patch.y >= 0 && patch.x <= frame_->width - kPatchSide &&
                                patch.y <= frame_->height - kPatchSide;
            if (!inside) continue;
            const int half = kPatchSide / 2;
            video_.patch_means.push_back({plane_mean(*frame_, 0, patch.x, patch.y, kPatchSide),
                                          plane_mean(*frame_, 1, patch.x / 2, patch.y / 2, half),
                                          plane_mean(*frame_, 2, patch.x / 2, patch.y / 2, half)});
        }
    }

    void describe_first_frame() {
        const AVFrame& frame = *frame_;
        video_.width_px = frame.width;
        video_.height_px = frame.height;
        video_.pixel_format = named(av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format)));
        video_.range = named(av_color_range_name(frame.color_range));
        video_.matrix = named(av_color_space_name(frame.colorspace));
        video_.primaries = named(av_color_primaries_name(frame.color_primaries));
        video_.transfer = named(av_color_transfer_name(frame.color_trc));
        video_.chroma_location = named(av_chroma_location_name(frame.chroma_location));
    }

    void describe() {
        video_.codec = avcodec_get_name(file_.context->codec_id);
        video_.profile = named(avcodec_profile_name(file_.context->codec_id, file_.context->profile));
    }

    static constexpr std::int64_t kMostBadFrames = 1000;
    /// No codec decodes more frames than that ahead of one that is shown before them.
    static constexpr std::size_t kMostReordered = 32;

    DecodedVideo& video_;
    VerifyDepth depth_;
    std::vector<ColorPatch> (*patches_of_)(const std::string&);
    LogCapture log_;
    OpenMp4 file_;
    Frame frame_;
    Packet packet_;
    std::int64_t last_pts_ = 0;
    bool is_described_ = false;
    /// Of packets, the least on top.
    std::priority_queue<std::int64_t, std::vector<std::int64_t>, std::greater<>> stamps_;
};

}  // namespace

DecodedVideo decode(const std::string& path, VerifyDepth depth,
                    std::vector<ColorPatch> (*patches_of)(const std::string& comment),
                    const OnProgress& on_progress) {
    DecodedVideo video;
    Decoding(video, depth, patches_of).run(path, on_progress);
    return video;
}

}  // namespace corda::media
