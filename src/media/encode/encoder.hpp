#pragma once

#include <functional>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Turns frames into the packets of one video track. Time stamps and durations of packets count frames.
class Encoder {
  public:
    using PacketSink = std::function<void(AVPacket&)>;

    Encoder() = default;
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;
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

}  // namespace corda::media
