#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"

namespace corda::media {

/// A few pixels of a frame whose colour is known: the mean RGB of the 16x16 pixels at (x, y).
struct ColorPatch {
    int x = 0;
    int y = 0;
    std::array<std::uint8_t, 3> rgb{};
};

/// Rendered colours of a frame at a few places.
struct FrameColors {
    std::int64_t frame = 0;
    std::vector<ColorPatch> patches;
};

/// Result of verifying a video file.
struct VerifyReport {
    std::string container;
    std::string codec;
    std::string profile;  ///< empty if the codec has none
    int h264_level = 0;   ///< ten times the stated level; 0: not H.264, or not stated
    std::string pixel_format;
    int width_px = 0;
    int height_px = 0;
    Rational fps;
    std::int64_t frames = 0;
    Rational duration_s{0, 1};  ///< exact: last time stamp plus its duration
    std::string range, matrix, primaries, transfer, chroma_location;
    bool faststart = false;
    bool alpha = false;                 ///< the first frame is transparent somewhere
    std::vector<std::string> problems;  ///< in words, each with a remedy; empty if the video is sound
    std::vector<std::string> notes;     ///< in words, such as what a browser will do with it

    [[nodiscard]] bool ok() const { return problems.empty(); }
    /// Codec, profile and level, e.g. "h264 High 4.0", "gif".
    [[nodiscard]] std::string coding() const;

    friend bool operator==(const VerifyReport&, const VerifyReport&) = default;
};

/// Which frames verify() decodes: those that can be decoded alone, of a chunk with known colours the first
/// and, if it is a key frame too, the last; or all. Of the others it reads the packets' time stamps.
enum class VerifyDepth { kKeyFrames, kAllFrames };

/// Opens, decodes and checks a video of any kind that Corda writes: that its boxes are whole and in order,
/// that its time stamps have a constant step from 0 (of a file that counts milliseconds, are the rounded
/// ones) and its clocks an exact duration, profile, pixel format and colour tags, and that every frame
/// decodes that is to be decoded. If the file's comment says that corda made it, also frame count, rate and
/// some colours of the first frame against the rendered ones; a caller that rendered it can pass more of
/// them in `rendered`, in the order of the frames, and in `fps` the rate, which a GIF of a few frames does
/// not show. What the other frames show is not compared with anything: a change that still decodes is not
/// found.
///
/// Throws corda::Error: kIo if the file cannot be opened for reading (one that is not a video gives a report
/// with a problem), kInterrupted if cancelled. libav ends the
/// process at some damaged files: one of unknown origin is for verify_in_child.
[[nodiscard]] VerifyReport verify(const std::string& path, VerifyDepth depth = VerifyDepth::kAllFrames,
                                  const std::vector<FrameColors>& rendered = {},
                                  std::optional<Rational> fps = {});

/// As `verify` with all frames, in a child process with limits on memory and time. If that crashes or exceeds
/// a limit, the file is damaged: a report with a problem. If the system starts no further process, it
/// verifies in this one. See run_in_child for what else
/// it throws, and why this process must have no other thread.
[[nodiscard]] VerifyReport verify_in_child(const std::string& path, std::optional<Rational> fps = {});

/// Does work that reads files of unknown origin, `bytes` in all, in such a child; in this process,
/// if it has other threads or the system starts no further process. Throws corda::Error: what `work` throws,
/// kMismatch, naming `path`, if the child crashes or exceeds a limit, and what run_in_child throws.
void work_in_child(const std::string& path, std::uint64_t bytes, const std::function<void()>& work);

}  // namespace corda::media
