#include <cstring>
#include <memory>
#include <string_view>

#include "corda/media/encode/alpha_bleed.hpp"
#include "corda/media/encode/encoders.hpp"
#include "corda/media/encode/libav_encoder.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/encode/x264_encoder.hpp"
#include "corda/media/png/png.hpp"

namespace corda::media {
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
    switch (format.codec->origin) {
        case EncoderOrigin::kX264:
            return make_x264_encoder(format, def);
        case EncoderOrigin::kPng:
            return std::make_unique<PictureEncoder>(def, first_frame, info);
        case EncoderOrigin::kLibav:
            break;
    }
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
