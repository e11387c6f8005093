#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// How the pixels of a video are stored.
enum class PixelChoice {
    kAuto,  ///< as the ending and its codec do by default
    k420,   ///< Y'CbCr with colour in half of the resolution: what every player shows
    k444,   ///< Y'CbCr in full resolution: sharper coloured edges; browsers and QuickTime refuse H.264 so
    kRgba,  ///< R'G'B' with alpha, exact
};

/// How a video is encoded. What is left open, the ending of the file decides.
struct EncoderDef {
    static constexpr int kMaxCrf = 63;
    static constexpr int kMaxThreads = 64;

    /// libav's name of the encoder or a short one ("h264"), see `corda doctor`; empty: by the ending.
    std::string codec;
    std::string preset;      ///< a word or a number of the encoder; empty: its default
    std::optional<int> crf;  ///< the encoder's constant rate factor, 1 .. kMaxCrf; empty: its default
    PixelChoice pix = PixelChoice::kAuto;
    /// Threads of the encoder, 1 .. kMaxThreads. Fixed, never the number of cores: x264's bytes depend on
    /// it.
    int threads = 4;
    /// Threads that draw frames, 0 .. kMaxThreads; 0: one per core. The bytes do not depend on it.
    int jobs = 0;
};

/// The picture size and rate of a video, and how long its frames are exposed.
struct VideoDef {
    static constexpr int kMaxSubframes = 64;
    static constexpr int kMaxLoop = 65535;
    static constexpr double kMaxHoldS = 3600.0;

    int width_px = 1920;  ///< see is_picture_size(); even for 4:2:0
    int height_px = 1080;
    FrameRate fps{Rational{60, 1}};
    /// Seconds of the scene per second of the video, 1e-6 .. 1e6: 1/4 is slow motion. Frame k shows the scene
    /// at exactly k * speed / fps.
    Rational speed{1, 1};
    /// The share of the interval between frames in which the shutter is open, 0 .. 1: motion is blurred. 0:
    /// no blur. It is open for as long before a frame's time as after, so that the frame shows on average
    /// where things are at its time; not before the motion's start, nor after its end.
    double shutter = 0.0;
    int subframes = 16;  ///< 2 .. kMaxSubframes: of how many pictures a blurred one is the mean
    /// How often a GIF plays, 0 .. kMaxLoop; 0: for ever.
    int loop = 0;
    /// 0 .. kMaxHoldS: how many seconds the last picture of the whole motion stays at the end of a video, by
    /// frames that repeat it; not of a sequence of pictures.
    double hold_s = 0.0;
    EncoderDef encoder;

    /// Gives the longer side this length, and keeps the shape.
    void scale_to(int longest_px) {
        const double scale = 1.0 * longest_px / std::max(width_px, height_px);
        for (int* const px : {&width_px, &height_px})
            *px = std::max(1, static_cast<int>(std::lround(scale * *px)));
    }

    /// The frames that repeat the last one.
    [[nodiscard]] std::int64_t held_frames() const { return std::llround(hold_s * fps.per_second()); }

    /// Frames per second of the scene: fps / speed. Requires that is_rate().
    [[nodiscard]] FrameRate scene_rate() const { return FrameRate(scene_fraction()); }
    [[nodiscard]] Rational scene_fraction() const {
        const Rational rate = fps.rational();
        return Rational::reduced(rate.num * speed.den, rate.den * speed.num);
    }
};

/// One of several processes, perhaps on several machines, that share the work of one command.
struct Shard {
    std::int64_t index = 0;  ///< 0 .. count - 1
    std::int64_t count = 1;
};

/// Metadata of a PNG.
struct PngInfo {
    /// Texts in file order: keyword (1..79 Latin-1 characters) and UTF-8 text; bytes that are not UTF-8
    /// are written as "\xe9". Long ones are compressed.
    std::vector<std::pair<std::string, std::string>> text;
    double pixels_per_inch = 96.0;  ///< written as pHYs; > 0
};

/// Writes `image` as 8-bit PNG with an sRGB and a pHYs chunk; opaque pictures are stored as RGB. The bytes
/// depend on nothing but the arguments. The file gets its name when it is complete. Throws
/// corda::Error: kIo, also if `path` exists and `options` do not say to replace it; kInterrupted if
/// cancelled.
void write_png(const std::string& path, const Image& image, const PngInfo& info = {},
               const OutputOptions& options = {});

/// Reads any PNG of a size that is_picture_size() as 8-bit RGBA. Throws corda::Error: kIo if it is larger,
/// before memory is taken, or if the file cannot be read or is not a complete PNG, kInterrupted if
/// cancelled.
[[nodiscard]] Image read_png(const std::string& path);

/// As read_png(), with all 16 bits if the file has as many per channel, which takes three times its memory.
[[nodiscard]] Picture read_picture(const std::string& path);

/// The texts of a PNG: of the first 30 in it (tEXt, zTXt and iTXt) those of at most 64 KiB. Throws
/// as read_png.
[[nodiscard]] PngInfo read_png_info(const std::string& path);

}  // namespace corda
#pragma GCC visibility pop
