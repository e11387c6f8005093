#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"

namespace corda::media {

struct Format;

/// Options of a libav encoder in addition to size, rate, threads and colours.
struct EncoderSettings {
    int profile = -99;                                         ///< libav's FF_PROFILE_UNKNOWN
    std::vector<std::pair<const char*, std::string>> options;  ///< the encoder's own, by libav's names
    /// How many frames decoding runs ahead of showing, if the encoder does not tell.
    std::optional<int> reorder_depth;
};

/// Whose encoder it is.
enum class EncoderOrigin { kLibav, kX264, kPng };

/// An encoder: one row of the table of codecs.
struct Codec {
    const char* name;        ///< libav's: "libx264"
    const char* short_name;  ///< "h264"
    const char* standard;    ///< in words: "H.264"
    /// libav's names of the pixel formats that it is given, the preferred ones first.
    std::array<const char*, 4> pixel_formats{};
    std::span<const char* const> presets{};  ///< empty: it has none
    const char* default_preset = "";
    std::optional<std::pair<int, int>> crf{};  ///< the least and the largest; empty: it has none
    int default_crf = 0;
    int least_side_px = 1;
    /// Most frames of a chunk, for codecs whose frames stand alone; 0: as many as frames_per_chunk() says.
    int chunk_frames = 0;
    bool is_hardware = false;  ///< it may be listed and not work
    EncoderOrigin origin = EncoderOrigin::kLibav;
    EncoderSettings (*settings)(const Format& format, const VideoDef& def) = nullptr;  ///< of libav's
    int most_height_px = kMaxSidePx;
    int default_crf_of_alpha = 0;  ///< in place of default_crf for transparent videos; 0: the same
};

/// How the packets of a video become files.
enum class FileKind {
    kVideo,      ///< one file with the packets of the part
    kAnimation,  ///< one file made from the exact pictures of the part: its encoder needs the whole film
    kPictures,   ///< a file for each frame
    kStream,     ///< standard output
};

/// An ending of a name: one row of the table of endings.
struct Ending {
    const char* text;   ///< ".mp4"; "-" is standard output
    const char* words;  ///< "MP4"
    FileKind kind;
    const char* muxer;       ///< libav's name
    const char* part_muxer;  ///< of the file that is written while the video is made
    /// libav's names of the codecs that it takes, the default first; of an animation, what its part holds.
    std::array<const char*, 5> codecs;
    const char* players;  ///< who shows it
    int most_side_px = kMaxSidePx;
};

/// How many times all frames are gone through: those of an animation are drawn, and encoded afterwards.
[[nodiscard]] std::int64_t passes(const Ending& ending);

/// The format that follows from a file name, a definition and a ground.
struct Format {
    const Ending* ending = nullptr;
    const Codec* codec = nullptr;
    const char* pixel_format = "";  ///< libav's name
    bool has_alpha = false;
    bool is_fallback = false;  ///< the ending's own codec is missing

    [[nodiscard]] std::string preset_of(const EncoderDef& def) const;
    [[nodiscard]] int crf_of(const EncoderDef& def) const;
    /// "H.264 in MP4", "GIF".
    [[nodiscard]] std::string words() const;
    /// The encoder: "libx264", "gif".
    [[nodiscard]] std::string encoder_name() const;
    /// The versions of libavformat and of libx264 or libavcodec: "libx264 164, libavformat 59.27.100".
    /// libavcodec does not tell those of the encoders behind it.
    [[nodiscard]] std::string library_versions() const;
};

/// The tables.
[[nodiscard]] std::span<const Ending> endings();
[[nodiscard]] std::span<const Codec> codecs();

/// Names of codecs that a definition may hold: libav's and the short ones, each once.
[[nodiscard]] std::vector<std::string_view> codec_names();
/// The presets of all codecs, each once.
[[nodiscard]] std::vector<std::string_view> preset_names();

/// The codec of this name of either kind; null for none. Of those with one short name it is the first.
[[nodiscard]] const Codec* find_codec(std::string_view name);

/// The row for the ending of `path`: of a name with a number in it ("%04d") that ends in .png, the pictures.
/// Throws corda::Error (kUsage), naming the endings that are known.
[[nodiscard]] const Ending& find_ending(std::string_view path);

/// The format of a file of this name. Throws corda::Error: kUsage, naming the field, the value and the
/// allowed ones, if the ending, the codec, the pixels, the preset, the crf, the size and the rate do not go
/// together; kEncoder if libavcodec has no codec for it.
[[nodiscard]] Format find_format(std::string_view path, const VideoDef& def, bool is_transparent = false);

/// Checks the fields that mean the same for every format. Throws corda::Error (kUsage), naming the field, the
/// value and what is allowed.
void check_video_def(const VideoDef& def);

/// Debian's package of the libavcodec that this program uses: "libavcodec59" in Debian 12.
[[nodiscard]] std::string libavcodec_package();

/// A ground that has transparency needs a format that keeps it: the endings that do, as ".webm, .mov".
[[nodiscard]] std::string endings_with_alpha();
/// Whether the first codec of an ending keeps alpha.
[[nodiscard]] bool can_be_transparent(const Ending& ending);

/// Checks a name of pictures: exactly one %d or %0Nd, N 1 .. 9, in the last part of the path, where %% is a
/// per cent sign. In folders each per cent sign is one. Throws corda::Error (kUsage).
void check_picture_names(std::string_view pattern);

/// The name of a frame: "frames/0007.png" for "frames/%04d.png". Requires a name that was checked.
[[nodiscard]] std::string picture_name(std::string_view pattern, std::int64_t frame);

/// Whether a name, without its folder, is that of a frame. Requires a pattern that was checked.
[[nodiscard]] bool is_picture_name(std::string_view pattern, std::string_view name);

}  // namespace corda::media
