#include "corda/media/encode/encoder.hpp"

#include <fmt/format.h>
#include <cassert>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/chunks/chunk.hpp"
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
    context.gop_size = static_cast<int>(frames_per_chunk(format, def.fps));
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

Frame frame_for(const AVCodecContext& context) {
    Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    frame->format = context.pix_fmt;
    frame->width = context.width;
    frame->height = context.height;
    frame->sample_aspect_ratio = context.sample_aspect_ratio;
    set_duration(*frame, 1);
    set_colors(context.pix_fmt, *frame);
    frame->chroma_location = context.chroma_sample_location;
    check_libav(av_frame_get_buffer(frame.get(), 0), ExitCode::kTemporary, "cannot make a picture");
    return frame;
}

}  // namespace

LibavEncoder::LibavEncoder(const Format& format, const VideoDef& def, Convert convert)
    : codec_(format.codec), convert_(std::move(convert)) {
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
    frame_ = frame_for(*context_);
}

LibavEncoder::~LibavEncoder() {
    if (!frame_ || !codec_->must_drain || is_drained_) return;
    const LogCapture log;
    if (frames_ == 0) {
        for (AVBufferRef* const buffer : frame_->buf)
            if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
        frame_->pts = 0;
        if (avcodec_send_frame(context_.get(), frame_.get()) < 0) return;
    }
    if (avcodec_send_frame(context_.get(), nullptr) < 0) return;
    while (avcodec_receive_packet(context_.get(), packet_.get()) >= 0) av_packet_unref(packet_.get());
}

void LibavEncoder::encode(const Image& frame, const Damage& damage, const PacketSink& sink) {
    assert(frame.width() == frame_->width && frame.height() == frame_->height);
    const LogCapture log;
    const PixelRect whole = frame.rect();
    const auto changed = frames_ == 0 ? std::span(&whole, 1) : std::span(damage);
    if (!changed.empty())
        check_libav(av_frame_make_writable(frame_.get()), ExitCode::kTemporary, "cannot copy a picture");
    for (const PixelRect& part : changed) convert_(frame, part, *frame_);
    frame_->pts = frames_;
    send(frame_.get(), sink);
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

namespace {

/// Each frame as the file that write_png() writes.
class PictureEncoder : public Encoder {
  public:
    PictureEncoder(const VideoDef& def, std::int64_t first_frame, PictureInfo info)
        : first_frame_(first_frame),
          info_(std::move(info)),
          parameters_(check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters")),
          packet_(check_allocated(Packet(av_packet_alloc()), "a packet")) {
        parameters_->codec_type = AVMEDIA_TYPE_VIDEO;
        parameters_->codec_id = AV_CODEC_ID_PNG;
        parameters_->width = def.width_px;
        parameters_->height = def.height_px;
    }

    void encode(const Image& frame, const Damage& /*damage*/, const PacketSink& sink) override {
        const CancelScope whole({}, CancelScope::Outer::kIgnored);  // half a frame is of no use
        const std::string bytes = png_bytes(frame, info_ ? info_(first_frame_ + frames_) : PngInfo{});
        check_libav(av_new_packet(packet_.get(), static_cast<int>(bytes.size())), ExitCode::kTemporary,
                    "cannot make a packet");
        std::memcpy(packet_->data, bytes.data(), bytes.size());
        packet_->pts = frames_++;
        packet_->duration = 1;
        packet_->flags |= AV_PKT_FLAG_KEY;
        sink(*packet_);
    }

    void drain(const PacketSink& /*sink*/) override {}
    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

  private:
    std::int64_t first_frame_;
    PictureInfo info_;
    CodecParameters parameters_;
    Packet packet_;
    std::int64_t frames_ = 0;
};

}  // namespace

std::unique_ptr<Encoder> make_encoder(const Format& format, const VideoDef& def, std::int64_t first_frame,
                                      const PictureInfo& info) {
    return format.codec->make(format, def, first_frame, info);
}

std::unique_ptr<Encoder> make_png_encoder(const Format& /*format*/, const VideoDef& def,
                                          std::int64_t first_frame, const PictureInfo& info) {
    return std::make_unique<PictureEncoder>(def, first_frame, info);
}

std::unique_ptr<Encoder> make_libav_encoder(const Format& format, const VideoDef& def,
                                            std::int64_t /*first_frame*/, const PictureInfo& /*info*/) {
    if (std::string_view(format.pixel_format) != "yuva420p")
        return std::make_unique<LibavEncoder>(format, def);
    return std::make_unique<LibavEncoder>(
        format, def,
        [fill = std::make_shared<AlphaBleed>()](const Image& image, const PixelRect& part, AVFrame& frame) {
            const PixelRect changed = fill->update(image, part);
            convert_pixels(fill->picture(), changed, frame);
        });
}

}  // namespace corda::media
