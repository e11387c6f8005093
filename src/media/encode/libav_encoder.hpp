#pragma once

#include <cstdint>
#include <functional>

#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Any encoder of libav in the table of codecs.
class LibavEncoder : public Encoder {
  public:
    /// Puts a part of a picture into a frame; see pixels.hpp.
    using Convert = std::function<void(const Image&, const PixelRect&, AVFrame&)>;

    /// Opens the encoder of `format`. Throws corda::Error (kEncoder).
    LibavEncoder(const Format& format, const VideoDef& def, Convert convert = convert_pixels);

    LibavEncoder(const LibavEncoder&) = delete;
    LibavEncoder& operator=(const LibavEncoder&) = delete;
    ~LibavEncoder() override;

    void encode(const Image& frame, const Damage& damage, const PacketSink& sink) override;
    void drain(const PacketSink& sink) override;
    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

  private:
    void send(const AVFrame* frame, const PacketSink& sink);

    QuietLog quiet_;
    Convert convert_;
    // The current picture. libav shares it by reference count. It is written only while nothing else holds
    // it, so it is copied only if the encoder keeps its frames.
    Frame frame_;
    CodecContext context_;
    CodecParameters parameters_;
    Packet packet_;
    std::int64_t frames_ = 0;
    bool is_drained_ = false;
};

}  // namespace corda::media
