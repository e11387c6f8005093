#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "corda/media/verify.hpp"

namespace corda::media {

/// What decoding an MP4 file has shown.
struct DecodedVideo {
    bool opened = false;      ///< the demuxer and a decoder accepted the file
    std::string open_reason;  ///< why it was not opened
    std::string codec, profile, pixel_format;
    std::string range, matrix, primaries, transfer, chroma_location;
    /// Range, matrix, primaries and transfer of the colr box, which QuickTime believes.
    std::string container_tags;
    int width_px = 0;
    int height_px = 0;
    Rational tick{0, 1};          ///< seconds per tick of the track's clock, as libav sees it
    std::int64_t frames = 0;      ///< those whose time stamp can be right
    std::int64_t first_pts = 0;   ///< in ticks
    std::int64_t step = 0;        ///< ticks from the first frame to the second, or the only frame's duration
    std::int64_t uneven_at = -1;  ///< index of the first frame that is not one step after the last; -1: none
    std::int64_t end = 0;         ///< last stamp plus one step, in ticks
    std::int64_t bad_frames = 0;  ///< frames or packets that did not decode cleanly or have no sane stamp
    std::string bad_reason;       ///< for the first of them, mostly in libav's words
    std::string comment;          ///< the file's comment
    /// Mean Y', Cb, Cr in the first frame of each patch inside the picture.
    std::vector<std::array<double, 3>> patch_means;
};

/// Decodes the frames of the MP4 file at `path`. `patches_of` is called with the file's comment and returns
/// the patches to measure in the first frame, `on_progress` with the frames. Throws corda::Error: kTemporary
/// if there is not enough memory, kInterrupted if `on_progress` asks to stop; nothing else for a bad file.
[[nodiscard]] DecodedVideo decode(const std::string& path, VerifyDepth depth,
                                  std::vector<ColorPatch> (*patches_of)(const std::string& comment),
                                  const OnProgress& on_progress);

}  // namespace corda::media
