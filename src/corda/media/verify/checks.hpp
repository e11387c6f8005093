#pragma once

#include <fmt/format.h>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/media/read/containers.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// A patch as it is in the video.
struct ShownPatch {
    std::int64_t frame = 0;
    ColorPatch rendered;
    /// Mean R'G'B' (0 .. 255, not clipped); std::nullopt outside of the picture.
    std::optional<std::array<double, 3>> rgb;
};

/// Result of decoding a file, in addition to what a VerifyReport holds.
struct DecodedVideo {
    bool opened = false;      ///< the demuxer and a decoder accepted the file
    std::string open_reason;  ///< why it was not opened
    std::string codec_tag;    ///< four letters in MP4 and QuickTime
    /// Range, matrix, primaries and transfer of the colr box, which QuickTime believes.
    std::string container_tags;
    Rational tick{0, 1};          ///< seconds per tick of the track's clock, as libav sees it
    std::int64_t first_pts = 0;   ///< in ticks
    std::int64_t step = 0;        ///< ticks from the first frame to the second, or the only frame's duration
    std::int64_t uneven_at = -1;  ///< index of the first frame that is not one step after the last; -1: none
    std::int64_t end = 0;         ///< last stamp plus one step, in ticks
    std::int64_t bad_frames = 0;  ///< frames or packets that did not decode cleanly or have no sane stamp
    std::string bad_reason;       ///< for the first of them, mostly in libav's words
    std::string comment;          ///< the file's comment
    bool is_yuv = false;          ///< not R'G'B'
    bool is_rounded = false;      ///< stamps count milliseconds, and each is the nearest to its frame's time
    std::vector<ShownPatch> patches;
};

/// Decodes the frames of the file at `path`, of a kind that libav demuxes, and measures the patches of
/// `rendered`, as far as these frames are decoded, and else those that the file's comment states for the
/// first one. Fills in the coding, size, colour tags and alpha of `report`, and the number of frames whose
/// time stamp can be right. `stated`: the rate of a GIF, if it fits. Throws corda::Error: kTemporary if there
/// is not enough memory, kInterrupted if cancelled; nothing else for a bad file.
[[nodiscard]] DecodedVideo decode(const std::string& path, VerifyDepth depth, std::optional<Rational> stated,
                                  const std::vector<FrameColors>& rendered, VerifyReport& report);

/// Rendered colours of a frame; null if `rendered`, in the order of the frames, has none.
[[nodiscard]] const FrameColors* find_rendered(const std::vector<FrameColors>& rendered, std::int64_t frame);

/// Adds a problem, in words.
template <typename... Args>
void problem(VerifyReport& report, fmt::format_string<Args...> text, Args&&... args) {
    report.problems.push_back(fmt::format(text, std::forward<Args>(args)...));
}

/// Checks the boxes of an MP4 or QuickTime file; false if it holds no stream to decode.
bool check_boxes(const Mp4Boxes& boxes, VerifyReport& report);
/// How to copy the pictures of a video into another file, with clocks that count its frames exactly. `before`
/// are further options, each with a space behind it.
[[nodiscard]] std::string copy_command(const VerifyReport& report, std::string_view ending,
                                       std::string_view before = {});
/// Checks that a browser can seek at once. `report` has the rate.
void check_index(const Mp4Boxes& boxes, VerifyReport& report);
/// Checks the stored clocks and durations, which are whole numbers and must agree exactly.
void check_clocks(const DecodedVideo& video, const Mp4Boxes& boxes, VerifyReport& report);

/// Checks that codec, pixel format and colour tags are what players show rightly.
void check_picture_format(const DecodedVideo& video, VerifyReport& report);
void check_tags(const DecodedVideo& video, VerifyReport& report);
/// Adds notes on the checks of a sound video, and on its players.
void add_notes(const DecodedVideo& video, VerifyDepth depth, VerifyReport& report);

}  // namespace corda::media
