#include "corda/media/yuv420_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <span>

#include "corda/core/basics.hpp"
#include "corda/media/chunk.hpp"

namespace corda::media {
namespace {

const AVCodec* find_codec(const char* name) {
    const AVCodec* codec = avcodec_find_encoder_by_name(name);
    if (codec != nullptr) return codec;
    throw Error(ExitCode::kEncoder,
                fmt::format("this libavcodec was built without {}; install one that has it (Debian: apt-get "
                            "install libavcodec59), and see `corda doctor`",
                            name));
}

void set_colors(AVCodecContext& context) {
    context.color_range = AVCOL_RANGE_MPEG;
    context.colorspace = AVCOL_SPC_BT709;
    context.color_primaries = AVCOL_PRI_BT709;
    // The bt709 transfer tag would be truer to the matrix and wrong on the screen: Safari and QuickTime wash
    // it out.
    context.color_trc = AVCOL_TRC_IEC61966_2_1;
    context.chroma_sample_location = AVCHROMA_LOC_LEFT;
}

void configure(AVCodecContext& context, const Format& format, const VideoDef& def) {
    const Rational fps = def.fps.rational();
    context.width = def.width_px;
    context.height = def.height_px;
    context.pix_fmt = av_get_pix_fmt(format.pixel_format);
    context.sample_aspect_ratio = {1, 1};
    context.time_base = frame_time_base(fps);
    context.framerate = to_libav(fps);
    context.gop_size = static_cast<int>(frames_per_chunk(def.fps));
    context.thread_count = def.encoder.threads;
    context.flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
    set_colors(context);
}

void open(AVCodecContext& context, const VideoDef& def, const EncoderSettings& settings) {
    const std::string encoder = context.codec->name;  // unknown once it has failed to open
    Options options;
    std::string text;
    for (const auto& [name, value] : settings.options) {
        options.set(name, value);
        text += fmt::format(", {} {}", name, value);
    }
    check_libav(avcodec_open2(&context, nullptr, options.get()), ExitCode::kEncoder,
                fmt::format("{} does not open for {}x{} at {} fps{}", encoder, def.width_px, def.height_px,
                            def.fps.rational().text(), text),
                "try another preset or size");
    if (const std::string name = options.left_over(); !name.empty()) {
        throw Error(ExitCode::kEncoder, fmt::format("{} does not know the option '{}'", encoder, name));
    }
}

Frame make_frame(const AVCodecContext& context) {
    Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    frame->format = context.pix_fmt;
    frame->width = context.width;
    frame->height = context.height;
    frame->sample_aspect_ratio = context.sample_aspect_ratio;
    frame->pkt_duration = 1;
    frame->color_range = context.color_range;
    frame->colorspace = context.colorspace;
    frame->color_primaries = context.color_primaries;
    frame->color_trc = context.color_trc;
    frame->chroma_location = context.chroma_sample_location;
    return frame;
}

}  // namespace

Yuv420Encoder::Yuv420Encoder(const Format& format, const VideoDef& def, const EncoderSettings& settings) {
    const LogCapture log;
    context_ = check_allocated(CodecContext(avcodec_alloc_context3(find_codec(format.codec))), "an encoder");
    context_->profile = settings.profile;
    configure(*context_, format, def);
    open(*context_, def, settings);
    parameters_ = check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
    check_libav(avcodec_parameters_from_context(parameters_.get(), context_.get()), ExitCode::kEncoder,
                "cannot read the encoder's parameters");
    packet_ = check_allocated(Packet(av_packet_alloc()), "a packet");
    frame_ = make_frame(*context_);
    hold(std::make_unique<Yuv420Image>(def.width_px, def.height_px));
}

void Yuv420Encoder::hold(std::unique_ptr<Yuv420Image> picture) {
    const auto release = [](void* opaque, std::uint8_t*) { delete static_cast<Yuv420Image*>(opaque); };
    const std::size_t luma_bytes = static_cast<std::size_t>(picture->width()) * picture->height();
    AVBufferRef* buffer = check_allocated(
        av_buffer_create(picture->plane(0), luma_bytes, release, picture.get(), 0), "a picture buffer");
    picture_ = picture.release();
    av_buffer_unref(&frame_->buf[0]);
    frame_->buf[0] = buffer;
    for (int index = 0; index < 3; ++index) {
        frame_->data[index] = picture_->plane(index);
        frame_->linesize[index] = picture_->plane_width(index);
    }
}

void Yuv420Encoder::encode(const Image& frame, const Damage& damage, const PacketSink& sink) {
    assert(frame.width() == picture_->width() && frame.height() == picture_->height());
    const LogCapture log;
    const PixelRect whole = frame.rect();
    const auto changed = frames_ == 0 ? std::span(&whole, 1) : std::span(damage);
    if (!changed.empty() && av_buffer_get_ref_count(frame_->buf[0]) > 1)
        hold(std::make_unique<Yuv420Image>(*picture_));
    for (const PixelRect& part : changed) convert_to_yuv420(frame, part, *picture_);
    frame_->pts = frames_;
    send(frame_.get(), sink);
    ++frames_;
}

void Yuv420Encoder::drain(const PacketSink& sink) {
    const LogCapture log;
    send(nullptr, sink);
}

void Yuv420Encoder::send(const AVFrame* frame, const PacketSink& sink) {
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

}  // namespace corda::media
