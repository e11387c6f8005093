#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "corda/core/image.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Turns frames into the packets of one video track. Time stamps and durations of packets count frames.
class Encoder : NonCopyable {
  public:
    using PacketSink = std::function<void(AVPacket&)>;

    virtual ~Encoder() = default;

    /// Encodes the next frame, in the pixel format and the size of the video; `changed` is where it may
    /// differ from the frame before. Packets that become ready go to `sink`. Throws corda::Error (kEncoder).
    virtual void encode(Frame frame, const Damage& changed, const PacketSink& sink) = 0;

    /// Ends the stream; the remaining packets go to `sink`. Throws corda::Error (kEncoder).
    virtual void drain(const PacketSink& sink) = 0;

    /// Stream parameters for the muxer.
    [[nodiscard]] virtual const AVCodecParameters& parameters() const = 0;
};

/// Frames from one key frame to the next: one to two seconds, 60 where both are possible.
[[nodiscard]] int key_interval(const FrameRate& fps);

/// Opens the encoder of a format for a definition that was checked. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_encoder(const Format& format, const VideoDef& def);

/// Any encoder of libav in the table of codecs.
class LibavEncoder : public Encoder {
  public:
    /// Opens the encoder of `format`. Throws corda::Error (kEncoder).
    LibavEncoder(const Format& format, const VideoDef& def);
    ~LibavEncoder() override;

    void encode(Frame frame, const Damage& changed, const PacketSink& sink) override;
    void drain(const PacketSink& sink) override;
    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

  private:
    void send(const AVFrame* frame, const PacketSink& sink);

    QuietLog quiet_;
    const Codec* codec_;
    CodecContext context_;
    CodecParameters parameters_;
    Packet packet_;
    std::int64_t frames_ = 0;
    bool is_drained_ = false;
};

/// "libx264 164"; empty if Corda was built without it (CORDA_X264).
[[nodiscard]] std::string x264_version();

/// Makes an encoder of libx264 that skips the macroblocks that are unchanged since the previous frame, for
/// which libavcodec has no interface. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_x264_encoder(const Format& format, const VideoDef& def);

}  // namespace corda::media
