#pragma once

#include <string>

namespace corda::media {

/// libav's name of the demuxer for a file, judged by its first bytes alone: "mov" (MP4 too), "matroska" (WebM
/// too), "gif", "apng", "webp" (of which libav knows no animation) or "yuv4mpegpipe"; empty for any other.
/// Throws corda::Error (kIo) if the file cannot be opened for reading.
///
/// libav is not asked, because it takes a text file for ANSI art, and follows a playlist.
[[nodiscard]] std::string file_kind(const std::string& path);

}  // namespace corda::media
