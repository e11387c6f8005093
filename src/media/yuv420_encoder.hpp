#pragma once

#include <string>
#include <utility>
#include <vector>

#include "corda/media/encoder.hpp"
#include "corda/media/format.hpp"
#include "corda/media/yuv420.hpp"

namespace corda::media {

/// What an encoder needs to know beside size, rate and threads.
struct EncoderSettings {
    int profile = FF_PROFILE_UNKNOWN;
    std::vector<std::pair<const char*, std::string>> options;  ///< the codec's own, by libav's names
};

/// Any encoder of libav that takes 8-bit Y'CbCr 4:2:0. The pictures are BT.709 in limited range with the sRGB
/// transfer, and tagged so.
class Yuv420Encoder : public Encoder {
  public:
    /// Opens the encoder of `format`. Throws corda::Error (kEncoder).
    Yuv420Encoder(const Format& format, const VideoDef& def, const EncoderSettings& settings);

    void encode(const Image& frame, const Damage& damage, const PacketSink& sink) override;
    void drain(const PacketSink& sink) override;
    [[nodiscard]] std::int64_t frames() const override { return frames_; }
    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

    [[nodiscard]] const AVCodecContext& context() const { return *context_; }

  private:
    /// Makes `picture` the one that frame_ shows.
    void hold(std::unique_ptr<Yuv420Image> picture);
    void send(const AVFrame* frame, const PacketSink& sink);

    QuietLog quiet_;
    // The current picture. libav shares it by reference count. It is written only while nobody else holds it,
    // so it is copied only if the encoder keeps its frames (x264 does not).
    Yuv420Image* picture_ = nullptr;  // owned by frame_
    Frame frame_;
    CodecContext context_;
    CodecParameters parameters_;
    Packet packet_;
    std::int64_t frames_ = 0;
};

}  // namespace corda::media
