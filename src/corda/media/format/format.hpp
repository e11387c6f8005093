#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"

namespace corda::media {

class Encoder;
struct Ending;
struct Format;

/// Options of an encoder of libav by libav's names, besides size, rate, threads and colours.
using EncoderOptions = std::vector<std::pair<const char*, std::string>>;

/// Metadata of a picture, by its number in the film.
using PictureInfo = std::function<PngInfo(std::int64_t frame)>;

/// Makes an encoder of libav by Codec::options.
[[nodiscard]] std::unique_ptr<Encoder> make_libav_encoder(const Format& format, const VideoDef& def);

/// An encoder: one row of the table of codecs.
struct Codec {
    const char* name;        ///< libav's: "libx264"
    const char* short_name;  ///< "h264"
    const char* standard;    ///< in words: "H.264"
    const char* stream;      ///< libav's name of the coded format: "h264"
    /// libav's names of the pixel formats that it takes, the preferred ones first.
    std::array<const char*, 4> pixel_formats{};
    std::span<const char* const> presets{};  ///< empty: it has none
    const char* default_preset = "";
    std::optional<std::pair<int, int>> crf{};  ///< the least and the largest; empty: it has none
    int default_crf = 0;
    int default_crf_of_alpha = 0;  ///< in place of default_crf for transparent videos; 0: the same
    int min_side_px = 1;
    int max_height_px = kMaxSidePx;
    bool is_hardware = false;     ///< it may be listed and not work
    bool is_built_in = false;     ///< it needs neither libav nor x264
    bool must_drain = false;      ///< closing it waits forever, unless a stream was begun and ended
    int own_threads = 0;          ///< threads that it starts by itself, at most
    double tolerance = 0.0;       ///< largest error of a colour patch, in 1/255; 0: by the crf
    bool has_coarse_444 = false;  ///< it quantises the colour of 4:4:4 more coarsely
    std::unique_ptr<Encoder> (*make)(const Format& format, const VideoDef& def) = &make_libav_encoder;
    EncoderOptions (*options)(const Format& format, const VideoDef& def) = nullptr;  ///< null: none
    std::string (*version)() = nullptr;  ///< of an encoder that is not libav's; gives "" if it is missing
};

/// How the packets of a video become files.
enum class FileKind {
    kVideo,      ///< one file, encoded frame by frame
    kAnimation,  ///< one file, whose encoder needs the whole film
    kPictures,   ///< a file for each frame
    kStream,     ///< standard output
};

/// An ending of a name: one row of the table of endings.
struct Ending {
    const char* text;   ///< ".mp4"; "-" is standard output
    const char* words;  ///< "MP4"
    FileKind kind;
    const char* muxer;  ///< libav's name
    /// libav's names of the codecs that it takes, the default first.
    std::array<const char*, 5> codecs;
};

/// How many times all frames are gone through: those of an animation are drawn, and encoded afterwards.
[[nodiscard]] std::int64_t passes(const Ending& ending);

/// The format that follows from a file name, a definition and a ground.
struct Format {
    const Ending* ending = nullptr;
    const Codec* codec = nullptr;
    const char* pixel_format = "";  ///< libav's name; of a GIF that of the frames before they get its palette
    bool has_alpha = false;
    bool is_fallback = false;  ///< the ending's own codec is missing

    [[nodiscard]] std::string preset_of(const EncoderDef& def) const;
    [[nodiscard]] int crf_of(const EncoderDef& def) const;
    /// "H.264 in MP4", "GIF".
    [[nodiscard]] std::string words() const;
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

/// The first codec of this name or short name; null for none.
[[nodiscard]] const Codec* find_codec(std::string_view name);

/// The row for the ending of `path`: of a name with a number in it ("%04d") that ends in .png, the pictures.
/// Throws corda::Error (kUsage), naming the endings that are known.
[[nodiscard]] const Ending& find_ending(std::string_view path);

/// The format of a file of this name. Throws corda::Error: kUsage, naming the field, the value and the
/// allowed ones, if the ending, the codec, the pixels, the preset, the crf, the size and the rate do not go
/// together; kEncoder if libavcodec has no codec for it.
[[nodiscard]] Format find_format(std::string_view path, const VideoDef& def, bool is_transparent = false);

/// Checks the fields that mean the same for every format. Throws corda::Error (kUsage), naming the field, the
/// value and the range.
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
