#include "benchmark/video/baseline_encoder.hpp"

#include <string>

#include "corda/core/basics.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::benchmark {
namespace {

using namespace media;  // this is an encoder as those of media/encode

CodecContext open_x264(const VideoDef& video, int threads) {
    const AVCodec* const codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr) throw Error(ExitCode::kEncoder, "this libavcodec was built without libx264");
    CodecContext context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "an encoder");
    context->width = video.width_px;
    context->height = video.height_px;
    context->pix_fmt = AV_PIX_FMT_YUV420P;
    context->time_base = frame_time_base(video.fps.rational());
    context->gop_size = key_interval(video.fps);
    context->thread_count = threads;
    Options options;
    const Format format{.codec = find_codec("libx264")};
    options.set("preset", format.preset_of(video.encoder))
        .set("crf", std::to_string(format.crf_of(video.encoder)));
    check_libav(avcodec_open2(context.get(), codec, options.get()), ExitCode::kEncoder,
                "libx264 does not open");
    return context;
}

/// A frame that refers to a picture, so that libav does not copy it first.
Frame frame_of(const test::Yuv420Image& picture) {
    Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    frame->format = AV_PIX_FMT_YUV420P;
    frame->width = picture.width();
    frame->height = picture.height();
    const auto keep = [](void*, std::uint8_t*) {};
    for (int plane = 0; plane < 3; ++plane) {
        auto* const samples = const_cast<std::uint8_t*>(picture.plane(plane));
        const std::size_t bytes =
            static_cast<std::size_t>(picture.plane_width(plane)) * picture.plane_height(plane);
        frame->buf[plane] = check_allocated(
            av_buffer_create(samples, bytes, keep, nullptr, AV_BUFFER_FLAG_READONLY), "a buffer");
        frame->data[plane] = samples;
        frame->linesize[plane] = picture.plane_width(plane);
    }
    return frame;
}

/// Sends a frame, or the end if it is null; returns the bytes of the packets.
std::int64_t send(AVCodecContext& context, const AVFrame* frame, AVPacket& packet) {
    check_libav(avcodec_send_frame(&context, frame), ExitCode::kEncoder, "libx264 takes no frame");
    std::int64_t bytes = 0;
    while (avcodec_receive_packet(&context, &packet) == 0) {
        bytes += packet.size;
        av_packet_unref(&packet);
    }
    return bytes;
}

}  // namespace

void BaselineEncoder::add(const Image& picture) {
    convert_to_yuv420(picture, picture.rect(), pictures_.emplace_back(def_.width_px, def_.height_px));
}

std::int64_t BaselineEncoder::encode(std::int64_t frames, int threads) const {
    const QuietLog quiet;
    const CodecContext context = open_x264(def_, threads);
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    const auto last = static_cast<std::int64_t>(pictures_.size()) - 1;
    std::int64_t bytes = 0;
    for (std::int64_t k = 0; k < frames; ++k) {
        const std::int64_t there_and_back = last == 0 ? 0 : k % (2 * last);
        const std::int64_t i = there_and_back <= last ? there_and_back : 2 * last - there_and_back;
        const Frame frame = frame_of(pictures_[static_cast<std::size_t>(i)]);
        frame->pts = k;
        bytes += send(*context, frame.get(), *packet);
    }
    return bytes + send(*context, nullptr, *packet);
}

}  // namespace corda::benchmark
