#pragma once

#include <cstdint>
#include <functional>

#include "corda/media/libav_handles.hpp"
#include "corda/media/video_writer.hpp"
#include "corda/media/yuv420.hpp"

namespace corda::media {

/// Checks every field of `def`. Throws corda::Error (kUsage), naming the field, the value and what is
/// allowed.
void check_video_def(const VideoDef& def);

/// libx264 at one size and rate. Time stamps are frame numbers.
class H264Encoder {
  public:
    using PacketSink = std::function<void(AVPacket&)>;

    /// Opens the encoder. Throws corda::Error (kEncoder).
    explicit H264Encoder(const VideoDef& def);

    /// Encodes the next frame: `frame` where `damage` touches it, the previous one elsewhere. Packets that
    /// become ready go to `sink`. Throws corda::Error (kEncoder).
    void encode(const Image& frame, const PixelRect& damage, const PacketSink& sink);

    /// Ends the stream; the remaining packets go to `sink`.
    void drain(const PacketSink& sink);

    [[nodiscard]] std::int64_t frames() const { return frames_; }

    /// What a muxer needs to know. Throws corda::Error (kEncoder).
    [[nodiscard]] const AVCodecParameters& parameters() const { return *parameters_; }

  private:
    struct ParametersDeleter {
        void operator()(AVCodecParameters* p) const noexcept { avcodec_parameters_free(&p); }
    };

    void make_picture_writable();
    void send(const AVFrame* frame, const PacketSink& sink);

    // The current picture. The frames handed to libav share it by reference count; it is written only while
    // nobody but us holds it, so no copy is made where the encoder takes its own (x264 does).
    Yuv420Image* picture_ = nullptr;  // owned by picture_ref_
    BufferRef picture_ref_;
    CodecContext context_;
    std::unique_ptr<AVCodecParameters, ParametersDeleter> parameters_;
    Packet packet_;
    std::int64_t frames_ = 0;
};

}  // namespace corda::media
