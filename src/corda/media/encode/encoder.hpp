#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Turns frames into the packets of one video track. Time stamps and durations of packets count frames.
class Encoder : NonCopyable {
  public:
    using PacketSink = std::function<void(AVPacket&)>;

    virtual ~Encoder() = default;

    /// Encodes the next frame: `frame` inside `damage` and the previous frame elsewhere; the first frame is
    /// taken whole. Packets that become ready go to `sink`. Throws corda::Error (kEncoder).
    virtual void encode(const Image& frame, const Damage& damage, const PacketSink& sink) = 0;

    /// The next frame is one whose colours are known. An encoder that knows what a decoder will show compares
    /// it, as soon as the frame is encoded, and throws corda::Error (kEncoder).
    virtual void expect(const std::vector<ColorPatch>& /*patches*/) {}

    /// Ends the stream; the remaining packets go to `sink`. Throws corda::Error (kEncoder).
    virtual void drain(const PacketSink& sink) = 0;

    /// Stream parameters for the muxer.
    [[nodiscard]] virtual const AVCodecParameters& parameters() const = 0;
};

/// Opens the encoder of a format for a definition that was checked, for a chunk that begins with frame
/// `first_frame`; a picture file says what `info` tells. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_encoder(const Format& format, const VideoDef& def,
                                                    std::int64_t first_frame = 0,
                                                    const PictureInfo& info = {});

/// Any encoder of libav in the table of codecs.
class LibavEncoder : public Encoder {
  public:
    /// Puts a part of a picture into a frame; see pixels.hpp.
    using Convert = std::function<void(const Image&, const PixelRect&, AVFrame&)>;

    /// Opens the encoder of `format`. Throws corda::Error (kEncoder).
    LibavEncoder(const Format& format, const VideoDef& def, Convert convert = convert_pixels);

    ~LibavEncoder() override;

    void encode(const Image& frame, const Damage& damage, const PacketSink& sink) override;
    void drain(const PacketSink& sink) override;
    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

  private:
    void send(const AVFrame* frame, const PacketSink& sink);

    QuietLog quiet_;
    const Codec* codec_;
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

/// "libx264 164"; empty if Corda was built without it (CORDA_X264).
[[nodiscard]] std::string x264_version();

/// Makes an encoder of libx264 that skips the macroblocks that are unchanged since the previous frame, for
/// which libavcodec has no interface. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_x264_encoder(const Format& format, const VideoDef& def,
                                                         std::int64_t first_frame, const PictureInfo& info);

/// Makes an encoder of frames as the files that write_png() writes, with the metadata of `info`.
[[nodiscard]] std::unique_ptr<Encoder> make_png_encoder(const Format& format, const VideoDef& def,
                                                        std::int64_t first_frame, const PictureInfo& info);

}  // namespace corda::media
