#include "corda/media/video_reader.hpp"

#include <cstring>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/media/open_video.hpp"
#include "corda/media/pixels.hpp"

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

VideoReader::VideoReader(const std::string& path) : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    impl_->file = open_video(path);
    impl_->packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    impl_->frame = check_allocated(Frame(av_frame_alloc()), "a frame");
}

VideoReader::~VideoReader() = default;

bool VideoReader::has_alpha() const {
    const AVPixFmtDescriptor* const descriptor = av_pix_fmt_desc_get(impl_->file.context->pix_fmt);
    return descriptor != nullptr && (descriptor->flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
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
    const AVFrame& frame = *impl_->frame;
    if (frame.format != AV_PIX_FMT_BGR0 && frame.format != AV_PIX_FMT_BGRA)
        impl_->fail_format("bgr0 or bgra");
    picture = image_of(frame);
    av_frame_unref(impl_->frame.get());
    return true;
}

bool VideoReader::read_shown(Image& picture) {
    const LogCapture log;
    if (!impl_->receive()) return false;
    impl_->shown.convert(*impl_->frame, picture);
    av_frame_unref(impl_->frame.get());
    return true;
}

}  // namespace corda::media
