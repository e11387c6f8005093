#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/yuv420.hpp"

namespace corda::media {

/// x264 by itself, on pictures in memory, with threads of its own: what the time of a render is compared
/// with.
class BaselineEncoder {
  public:
    /// For videos of this size, rate, preset and crf.
    explicit BaselineEncoder(const VideoDef& def) : def_(def) {}

    /// Converts a picture and keeps it.
    void add(const Image& picture);

    /// Encodes so many frames: the pictures in order, then backwards, and so on, with no jump between them.
    /// Requires a picture. Returns the bytes of the packets. Throws corda::Error (kEncoder).
    [[nodiscard]] std::int64_t encode(std::int64_t frames, int threads) const;

  private:
    VideoDef def_;
    std::vector<Yuv420Image> pictures_;
};

}  // namespace corda::media
