#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"

namespace corda::media {

/// A few pixels of the first frame whose colour is known: the mean RGB of the 16x16 pixels at (x, y).
struct ColorPatch {
    int x = 0;
    int y = 0;
    std::array<std::uint8_t, 3> rgb{};
};

/// What `verify` found in a video file.
struct VerifyReport {
    std::string container;
    std::string codec;
    std::string profile;
    std::string pixel_format;
    int width_px = 0;
    int height_px = 0;
    Rational fps;
    std::int64_t frames = 0;
    Rational duration_s{0, 1};  ///< exact: last time stamp plus its duration
    std::string range, matrix, primaries, transfer, chroma_location;
    bool faststart = false;
    std::vector<std::string> problems;  ///< in words, each with a remedy; empty if the video is sound
    std::vector<std::string> notes;     ///< in words, such as what a browser will do with it

    [[nodiscard]] bool ok() const { return problems.empty(); }
};

/// Opens, decodes and checks a video: frame count, constant step from 0, exact duration, track and movie time
/// scale, profile and pixel format, colour tags, faststart. If the file's comment says that corda made it,
/// also frame count, rate and colour patches of the first decoded frame against what was rendered. Throws
/// corda::Error (kIo) only if the file cannot be opened for reading; a file that is not a video gives a
/// report with a problem.
[[nodiscard]] VerifyReport verify(const std::string& path);

}  // namespace corda::media
