#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"

namespace corda::media {

/// How a video is encoded.
struct EncoderDef {
    std::string codec = "libx264";  ///< libav's name of the encoder; "libx264" is the one that exists
    std::string preset = "medium";  ///< x264: ultrafast .. placebo
    int crf = 18;  ///< x264 constant rate factor, 1 .. 51 (0 selects High 4:4:4, which browsers refuse)
    /// Threads of the encoder, 1 .. 64. Fixed, never "as many as there are cores": x264's bytes depend on it.
    int threads = 2;
};

/// The picture size and rate of a video.
struct VideoDef {
    int width_px = 1920;  ///< 1 .. 16384, at most 2^26 pixels a frame; even for H.264
    int height_px = 1080;
    FrameRate fps{Rational{60, 1}};
    EncoderDef encoder;
};

/// The names of x264's presets, fastest first.
[[nodiscard]] const std::vector<std::string>& x264_presets();

/// Checks every field of `def`, so that a bad one is refused before any work is done. Throws corda::Error
/// (kUsage), naming the field, the value and what is allowed; for an odd size the nearest even ones.
void check_video_def(const VideoDef& def);

/// What stands in the file beside the pictures.
struct VideoMetadata {
    std::string title;
    /// Compact JSON that `verify` reads back; VideoWriter adds "frames", "fps", "crf" and "patches" to it
    /// (see verify.hpp).
    std::string comment_json = "{}";
};

/// Writes one H.264 MP4: High profile, yuv420p, BT.709 limited range with the sRGB transfer, faststart, one
/// constant rational frame rate.
///
/// While it runs, whole fragments go to `PATH.part`, which plays at any moment. `finish` drains the encoder,
/// copies the stream into a plain faststart MP4 (`PATH.tmp`), verifies that, and only then gives it the final
/// name. Nothing ever stands under the final name that is not complete and verified.
class VideoWriter {
  public:
    /// Opens the encoder and the part file. Throws corda::Error: kUsage for an odd size (naming the nearest
    /// even ones), kEncoder where the encoder is missing or refuses, kIo where the file cannot be made.
    VideoWriter(std::string path, const VideoDef& def, VideoMetadata metadata);
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;
    /// Without `finish` or `abandon` the part file stays as it is.
    ~VideoWriter();

    /// Adds the next frame, of the size of `def`. `damage` is what may differ from the previous frame (the
    /// first is taken whole). Throws kEncoder or kIo.
    void write(const Image& frame, const PixelRect& damage);

    /// Frames written so far.
    [[nodiscard]] std::int64_t frames() const;

    /// Drains, closes, copies, verifies, and renames to the final name. Needs at least one frame. Throws
    /// kEncoder, kIo or kMismatch (verify found a problem; the file stays as `PATH.part`).
    void finish();

    /// Drains and closes the part file, which stays as a playable `PATH.part`, and returns its path.
    std::string abandon();

    [[nodiscard]] static std::string part_path(const std::string& path) { return path + ".part"; }

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Whether an encoder opens on this machine, and libav's reason where it does not.
struct EncoderProbe {
    std::string name;
    bool usable = false;
    std::string reason;  ///< empty where it is usable
};

/// Opens every encoder that Corda may come to use with a small picture, and reports: listed is not usable.
[[nodiscard]] std::vector<EncoderProbe> probe_encoders();

}  // namespace corda::media
