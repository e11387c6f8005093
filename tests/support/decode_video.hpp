#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/yuv420_image.hpp"

namespace corda::test {

/// A video as libav decodes it, read independently of corda::media.
struct DecodedFrames {
    std::vector<std::int64_t> pts;  ///< in ticks of the track
    std::vector<Yuv420Image> pictures;
    int tick_num = 0;
    int tick_den = 0;
    std::int64_t stream_duration = 0;        ///< in ticks, from the container
    std::int64_t container_duration_us = 0;  ///< from the container
    int range = 0, matrix = 0, primaries = 0, transfer = 0, chroma_location = 0;  ///< libav's numbers
};

/// Decodes all frames of a yuv420p video. Throws std::runtime_error on any error.
[[nodiscard]] DecodedFrames decode_video(const std::string& path);

/// Which colour tags copy_video replaces by BT.601 and BT.709 transfer.
enum class Retag { kNone, kContainer, kStream };

/// Stream-copies `from` to an MP4 with libav's default layout (index after the frames, default time bases).
void copy_video(const std::string& from, const std::string& to, Retag retag);

}  // namespace corda::test
