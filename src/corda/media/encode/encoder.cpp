#include "corda/media/encode/encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/media/encode/pixels.hpp"

namespace corda::media {
namespace {

void configure(AVCodecContext& context, const Format& format, const VideoDef& def) {
    const Rational fps = def.fps.rational();
    context.width = def.width_px;
    context.height = def.height_px;
    context.pix_fmt = av_get_pix_fmt(format.pixel_format);
    context.sample_aspect_ratio = {1, 1};
    context.time_base = frame_time_base(fps);
    context.framerate = to_libav(fps);
    context.gop_size = key_interval(def.fps);
    context.thread_count = def.encoder.threads;
    context.flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
    set_colors(context.pix_fmt, context);
    context.chroma_sample_location = chroma_location(context.pix_fmt);
}

void open(AVCodecContext& context, const VideoDef& def, const EncoderOptions& settings) {
    // Unknown once it has failed to open.
    const std::string encoder = context.codec->name;
    const bool is_hardware = (context.codec->capabilities & AV_CODEC_CAP_HARDWARE) != 0;
    Options options;
    std::string text;
    for (const auto& [name, value] : settings) {
        options.set(name, value);
        text += fmt::format(", {} {}", name, value);
    }
    check_libav(avcodec_open2(&context, nullptr, options.get()), ExitCode::kEncoder,
                fmt::format("{} does not open for {}x{} at {} fps{}", encoder, def.width_px, def.height_px,
                            def.fps.rational().text(), text),
                is_hardware ? "try another codec: this one needs hardware and its driver"
                            : "try another preset, size or codec");
    if (const std::string name = options.left_over(); !name.empty())
        throw_error(ExitCode::kEncoder, "{} does not know the option '{}'", encoder, name);
}

}  // namespace

int key_interval(const FrameRate& fps) {
    constexpr double kFrames = 60.0;
    const double per_second = fps.rational().value();
    return static_cast<int>(std::max(1L, std::lround(std::clamp(kFrames, per_second, 2.0 * per_second))));
}

LibavEncoder::LibavEncoder(const Format& format, const VideoDef& def) : codec_(format.codec) {
    const LogCapture log;
    const AVCodec* const codec = avcodec_find_encoder_by_name(format.codec->name);
    if (codec == nullptr)
        throw_error(ExitCode::kEncoder, "this libavcodec was built without {}; see `corda doctor`",
                    format.codec->name);
    context_ = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "an encoder");
    configure(*context_, format, def);
    open(*context_, def,
         format.codec->options == nullptr ? EncoderOptions{} : format.codec->options(format, def));
    context_->has_b_frames = 0;  // none has any; some encoders leave it unset
    parameters_ = check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
    check_libav(avcodec_parameters_from_context(parameters_.get(), context_.get()), ExitCode::kEncoder,
                "cannot read the encoder's parameters");
    packet_ = check_allocated(Packet(av_packet_alloc()), "a packet");
}

LibavEncoder::~LibavEncoder() {
    if (!context_ || !codec_->must_drain || is_drained_) return;
    const LogCapture log;
    try {
        if (frames_ == 0) {
            const Frame blank = new_frame(context_->pix_fmt, context_->width, context_->height);
            for (AVBufferRef* const buffer : blank->buf)
                if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
            blank->pts = 0;
            if (avcodec_send_frame(context_.get(), blank.get()) < 0) return;
        }
    } catch (const Error&) {
        return;
    }
    if (avcodec_send_frame(context_.get(), nullptr) < 0) return;
    while (avcodec_receive_packet(context_.get(), packet_.get()) >= 0) av_packet_unref(packet_.get());
}

void LibavEncoder::encode(Frame frame, const Damage& /*changed*/, const PacketSink& sink) {
    assert(frame->width == context_->width && frame->height == context_->height);
    const LogCapture log;
    frame->pts = frames_;
    send(frame.get(), sink);
    ++frames_;
}

void LibavEncoder::drain(const PacketSink& sink) {
    const LogCapture log;
    send(nullptr, sink);
    is_drained_ = true;
}

void LibavEncoder::send(const AVFrame* frame, const PacketSink& sink) {
    check_libav(avcodec_send_frame(context_.get(), frame), ExitCode::kEncoder,
                fmt::format("{} refused frame {}", context_->codec->name, frames_));
    for (;;) {
        const int status = avcodec_receive_packet(context_.get(), packet_.get());
        if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
        check_libav(status, ExitCode::kEncoder,
                    fmt::format("{} failed near frame {}", context_->codec->name, frames_));
        packet_->duration = 1;
        sink(*packet_);
    }
}

std::unique_ptr<Encoder> make_encoder(const Format& format, const VideoDef& def) {
    return format.codec->make(format, def);
}

std::unique_ptr<Encoder> make_libav_encoder(const Format& format, const VideoDef& def) {
    return std::make_unique<LibavEncoder>(format, def);
}

}  // namespace corda::media
