#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "corda/media/defs.hpp"

namespace corda::media {

class Encoder;

/// A kind of video file that Corda writes: one row of the table of formats. An ending that takes several
/// codecs has a row for each, its default first. A new codec is a row in format.cpp and a file with its two
/// functions.
struct Format {
    const char* ending;        ///< of the file name: ".mp4"
    const char* container;     ///< libav's name of the muxer
    const char* codec;         ///< libav's name of the encoder
    const char* pixel_format;  ///< libav's name of the pixel format that the encoder is given
    bool has_alpha;            ///< whether it keeps what is transparent

    /// Checks the fields of a def that mean something to this encoder alone. Throws corda::Error (kUsage).
    void (*check)(const VideoDef& def);
    /// Opens the encoder for a def that was checked. Throws corda::Error (kEncoder).
    std::unique_ptr<Encoder> (*make_encoder)(const Format& format, const VideoDef& def);
};

/// The table.
[[nodiscard]] std::span<const Format> formats();

/// libav's names of the encoders in the table, each once.
[[nodiscard]] std::vector<std::string_view> codec_names();

/// The row for the ending of `path` and, if it is not empty, for `codec`. Throws corda::Error (kUsage),
/// naming the endings or the codecs that are known.
[[nodiscard]] const Format& find_format(std::string_view path, std::string_view codec = {});

/// Checks every field of `def`, so that a bad one is refused before any work is done. Throws corda::Error
/// (kUsage), naming the field, the value and what is allowed; for an odd size, the nearest even ones.
void check_video_def(const VideoDef& def);

}  // namespace corda::media
