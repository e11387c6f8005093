#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "support/yuv420_image.hpp"

namespace corda::benchmark {

/// x264 alone, on pictures in memory, with threads of its own: the baseline of the time of a render.
class BaselineEncoder {
  public:
    /// For videos of this size, rate, preset and crf.
    explicit BaselineEncoder(const VideoDef& def) : def_(def) {}

    /// Converts a picture and keeps it.
    void add(const Image& picture);

    /// Encodes `frames` frames: the pictures forwards, then backwards, and so on, so that nothing jumps.
    /// Requires a picture. Returns the bytes of the packets. Throws corda::Error (kEncoder).
    [[nodiscard]] std::int64_t encode(std::int64_t frames, int threads) const;

  private:
    VideoDef def_;
    std::vector<test::Yuv420Image> pictures_;
};

}  // namespace corda::benchmark
