#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "corda/media/verify.hpp"

namespace corda::media {

/// What decoding a whole MP4 file gave.
struct DecodedVideo {
    bool opened = false;      ///< the demuxer and a decoder accepted the file
    std::string open_reason;  ///< why not, where not opened
    std::string codec, profile, pixel_format;
    std::string range, matrix, primaries, transfer, chroma_location;
    std::string
        container_tags;  ///< range, matrix, primaries, transfer of the colr box, which QuickTime believes
    int width_px = 0;
    int height_px = 0;
    Rational tick{0, 1};  ///< seconds a tick of the track's clock, as libav sees it
    std::int64_t frames = 0;
    std::int64_t first_pts = 0;   ///< in ticks
    std::int64_t step = 0;        ///< ticks from the first frame to the second, or the only frame's duration
    std::int64_t uneven_at = -1;  ///< index of the first frame that is not one step after the last; -1: none
    std::int64_t end = 0;         ///< last stamp plus one step, in ticks
    std::int64_t container_duration_us = 0;  ///< what libav tells players, in microseconds; 0: nothing
    std::int64_t bad_frames = 0;             ///< frames or packets that did not decode cleanly
    std::string bad_reason;                  ///< libav's words for the first of them
    std::string comment;                     ///< the file's comment
    std::vector<std::array<double, 3>>
        patch_means;  ///< mean Y', Cb, Cr of each asked patch in the first frame
};

/// Decodes every frame of the MP4 file at `path`. `patches` are asked for by the caller once the comment is
/// known, through `patches_of`, which is called with it before the first frame. Never throws for a bad file.
[[nodiscard]] DecodedVideo decode_all(const std::string& path,
                                      std::vector<ColorPatch> (*patches_of)(const std::string& comment));

}  // namespace corda::media
