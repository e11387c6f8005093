#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Frames of a video that were encoded apart from all others: they begin with a key frame, and nothing before
/// or after them is needed to decode them.
struct Chunk {
    std::int64_t first = 0;  ///< number of the first frame in the film
    std::int64_t frames = 0;
    /// One per frame, in order: no encoder here makes B-frames.
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
    /// Takes the encoder of a chunk that begins with frame `first` of the film. Throws corda::Error
    /// (kEncoder), like all below.
    ChunkEncoder(std::unique_ptr<Encoder> encoder, std::int64_t first);

    /// Adds the next frame, of the size of the def. `damage` is what may differ from the previous frame (the
    /// first is taken whole).
    void encode(const Image& frame, const Damage& damage, bool is_last = false);
    [[nodiscard]] std::int64_t frames() const { return chunk_.frames; }
    /// Drains the encoder. Nothing can be added afterwards. Throws kInterrupted if cancelled at a frame that
    /// the encoder has held back.
    [[nodiscard]] Chunk finish();

  private:
    /// Moves a packet to the chunk.
    void keep(AVPacket& packet);

    std::unique_ptr<Encoder> encoder_;
    Chunk chunk_;
};

/// Writes a chunk to a file that plays by itself. Its comment tells the colours of its first and its last
/// frame. Its packets are empty afterwards. Throws corda::Error (kIo).
void write_chunk(const Chunk& chunk, const Format& format, Rational fps, OutputFile& output);

}  // namespace corda::media
