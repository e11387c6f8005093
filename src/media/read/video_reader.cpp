#include "corda/media/read/video_reader.hpp"

#include <cstring>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/read/open_video.hpp"

namespace corda::media {
namespace {

void copy_picture(const AVFrame& frame, Yuv420Image& picture) {
    if (picture.width() != frame.width || picture.height() != frame.height) {
        picture = Yuv420Image(frame.width, frame.height);
    }
    for (int plane = 0; plane < 3; ++plane) {
        const auto width = static_cast<std::size_t>(picture.plane_width(plane));
        for (int row = 0; row < picture.plane_height(plane); ++row) {
            std::memcpy(picture.plane(plane) + static_cast<std::size_t>(row) * width,
                        frame.data[plane] + std::ptrdiff_t{row} * frame.linesize[plane], width);
        }
    }
}

/// The samples of a component, from `samples` on.
void copy_component(const AVFrame& frame, const AVPixFmtDescriptor& descriptor, int component, int width,
                    int height, std::uint16_t* samples) {
    const std::uint8_t* data[4] = {frame.data[0], frame.data[1], frame.data[2], frame.data[3]};
    for (int y = 0; y < height; ++y)
        av_read_image_line2(samples + std::ptrdiff_t{y} * width, data, frame.linesize, &descriptor, 0, y,
                            component, width, 0, sizeof(std::uint16_t));
}

}  // namespace

struct VideoReader::Impl {
    QuietLog quiet;
    std::string path;
    OpenVideo file;
    Packet packet;
    Frame frame;
    ShownPictures shown;
    bool is_draining = false;

    [[noreturn]] void fail(int status) const {
        fail_libav(ExitCode::kIo, fmt::format("{}: decoding failed", path), status);
    }

    /// Hands the decoder the next packet of the track, or the end of the file.
    void feed() {
        for (;;) {
            const int status = av_read_frame(file.format.get(), packet.get());
            if (status == AVERROR_EOF) {
                is_draining = true;
                avcodec_send_packet(file.context.get(), nullptr);
                return;
            }
            if (status < 0) fail(status);
            const bool is_ours = packet->stream_index == file.stream->index;
            const int sent = is_ours ? avcodec_send_packet(file.context.get(), packet.get()) : 0;
            av_packet_unref(packet.get());
            if (sent < 0) fail(sent);
            if (is_ours) return;
        }
    }

    bool receive() {
        for (;;) {
            const int status = avcodec_receive_frame(file.context.get(), frame.get());
            if (status == AVERROR_EOF) return false;
            if (status == AVERROR(EAGAIN) && !is_draining) {
                feed();
                continue;
            }
            if (status < 0) fail(status);
            if (frame->decode_error_flags != 0) fail(AVERROR_INVALIDDATA);
            return true;
        }
    }

    [[noreturn]] void fail_format(const char* wanted) const {
        throw Error(ExitCode::kIo, fmt::format("{}: is {} of {}x{}; only {} is read", path,
                                               av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame->format)),
                                               frame->width, frame->height, wanted));
    }
};

VideoReader::VideoReader(const std::string& path, std::optional<std::uint64_t> bytes)
    : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    impl_->file = open_video(path, bytes);
    impl_->packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    impl_->frame = check_allocated(Frame(av_frame_alloc()), "a frame");
}

VideoReader::~VideoReader() = default;

bool VideoReader::has_alpha() const {
    const AVPixFmtDescriptor* const descriptor = av_pix_fmt_desc_get(impl_->file.context->pix_fmt);
    return descriptor != nullptr && (descriptor->flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
}

Rational VideoReader::rate() const {
    const AVRational rate = impl_->file.stream->avg_frame_rate;
    return rate.den > 0 ? Rational::reduced(rate.num, rate.den) : Rational{0, 1};
}

bool VideoReader::read(StoredPicture& picture) {
    const LogCapture log;
    if (!impl_->receive()) return false;
    const AVFrame& frame = *impl_->frame;
    const AVPixFmtDescriptor* const format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    constexpr std::uint64_t kUnread = AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_FLOAT |
                                      AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_BAYER;
    const bool is_known = format != nullptr && (format->flags & kUnread) == 0 &&
                          format->comp[0].depth <= 16 &&
                          (format->nb_components == 1 || format->nb_components >= 3);
    if (!is_known || !is_picture_size(frame.width, frame.height))
        impl_->fail_format("grey, R'G'B' or Y'CbCr of up to 16 bits");
    picture.width_px = frame.width;
    picture.height_px = frame.height;
    picture.format = format->name;
    picture.components = format->nb_components;
    picture.is_rgb = (format->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    picture.is_full_range = frame.color_range == AVCOL_RANGE_JPEG;
    picture.bits = format->comp[0].depth;
    picture.chroma_shift_x = format->log2_chroma_w;
    picture.chroma_shift_y = format->log2_chroma_h;
    const AVRational base = impl_->file.stream->time_base;
    const bool has_time = frame.best_effort_timestamp != AV_NOPTS_VALUE;
    picture.time_s = has_time ? static_cast<double>(frame.best_effort_timestamp) * av_q2d(base) : 0.0;
    const auto pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    picture.samples.assign(pixels * static_cast<std::size_t>(picture.components), 0);
    for (int c = 0; c < picture.components; ++c) {
        const bool is_chroma = !picture.is_rgb && (c == 1 || c == 2);
        copy_component(frame, *format, c, ceiling_shift(frame.width, is_chroma ? format->log2_chroma_w : 0),
                       ceiling_shift(frame.height, is_chroma ? format->log2_chroma_h : 0),
                       picture.samples.data() + static_cast<std::size_t>(c) * pixels);
    }
    av_frame_unref(impl_->frame.get());
    return true;
}

bool VideoReader::read(Yuv420Image& picture) {
    const LogCapture log;
    if (!impl_->receive()) return false;
    const AVFrame& frame = *impl_->frame;
    const bool is_known = frame.format == AV_PIX_FMT_YUV420P && frame.width % 2 == 0 && frame.height % 2 == 0;
    if (!is_known) impl_->fail_format("yuv420p with even sides");
    copy_picture(frame, picture);
    av_frame_unref(impl_->frame.get());
    return true;
}

bool VideoReader::read(Image& picture) {
    const LogCapture log;
    if (!impl_->receive()) return false;
    if (!copy_exact(*impl_->frame, picture)) impl_->fail_format("bgr0, bgra, argb or rgb24");
    av_frame_unref(impl_->frame.get());
    return true;
}

void VideoReader::skip() {
    const LogCapture log;
    if (!impl_->receive()) impl_->fail(AVERROR_EOF);
    av_frame_unref(impl_->frame.get());
}

bool VideoReader::read_shown(Image& picture) {
    const LogCapture log;
    if (!impl_->receive()) return false;
    impl_->shown.convert(*impl_->frame, picture);
    av_frame_unref(impl_->frame.get());
    return true;
}

}  // namespace corda::media
