#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Seconds that an encoder may take, after a request to stop, to encode the frames that it holds back.
inline constexpr double kMomentS = 0.4;

/// Frames of a video that were encoded apart from all others: they begin with a key frame, and nothing before
/// or after them is needed to decode them.
struct Chunk {
    std::int64_t frames = 0;
    /// In the order of decoding. Their stamps and durations count frames from the first one of the chunk.
    std::vector<Packet> packets;
    CodecParameters parameters;       ///< the same for all chunks of a video; null without a frame
    std::vector<FrameColors> colors;  ///< of the first frame and the one marked as last
};

/// Frames per chunk, except in the last chunk of a video: 60, but at least as many as a second has and
/// at most as two have; fewer of codecs whose frames stand alone. Frame k is in chunk k / frames_per_chunk()
/// of the whole film, whatever part of it is rendered and by how many encoders, so that the bytes depend on
/// neither.
[[nodiscard]] std::int64_t frames_per_chunk(const FrameRate& fps);
[[nodiscard]] std::int64_t frames_per_chunk(const Format& format, const FrameRate& fps);

/// Makes one chunk. Several may work at a time, in threads of their own.
class ChunkEncoder {
  public:
    /// Takes the encoder of a chunk. Throws corda::Error (kEncoder), like all below.
    explicit ChunkEncoder(std::unique_ptr<Encoder> encoder);

    /// Adds the next frame, of the size of the def. `damage` is what may differ from the previous frame (the
    /// first is taken whole).
    void encode(const Image& frame, const Damage& damage, bool is_last = false);
    [[nodiscard]] std::int64_t frames() const { return chunk_.frames; }
    /// Drains the encoder. Nothing can be added afterwards. No scope around it cancels it, because its frames
    /// have been drawn; if `goes_on` returns false at a frame that the encoder has held back, the chunk is
    /// dropped (kInterrupted).
    [[nodiscard]] Chunk finish(std::function<bool()> goes_on = {});

  private:
    /// Moves a packet to the chunk.
    void keep(AVPacket& packet);

    std::unique_ptr<Encoder> encoder_;
    Chunk chunk_;
};

}  // namespace corda::media
