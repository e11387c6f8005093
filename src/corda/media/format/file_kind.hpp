#pragma once

#include <string>
#include <string_view>

namespace corda::media {

/// libav's name of the demuxer for a file, judged by its first bytes alone: "mov" (MP4 too), "matroska" (WebM
/// too), "gif" or "yuv4mpegpipe"; empty for any other.
/// Throws corda::Error (kIo) if the file cannot be opened for reading.
///
/// libav is not asked, because it takes a text file for ANSI art, and follows a playlist.
[[nodiscard]] std::string file_kind(const std::string& path);

/// The first bytes of every PNG.
inline constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

/// True if a file begins as every PNG does. Throws corda::Error (kIo) if it cannot be read.
[[nodiscard]] bool is_png(const std::string& path);

/// The remedy for a picture of another kind that was given as a picture.
inline constexpr std::string_view kConvertToPng = "convert it to PNG";

/// The kind of a file that was given as a picture or a video.
struct ForeignKind {
    std::string_view words;  ///< "a Git LFS pointer"
    std::string_view remedy;
};

/// Judges a file by its first bytes, some 500 of them: a pointer file, text, or a picture of another kind;
/// nullptr for any other. The result lives for ever.
[[nodiscard]] const ForeignKind* foreign_kind(std::string_view head);
/// As above, of a file. Throws corda::Error (kIo) if the file cannot be read.
[[nodiscard]] const ForeignKind* foreign_kind_of(const std::string& path);

}  // namespace corda::media
