#pragma once

#include <cstddef>
#include <string>

#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// True if this libavformat, of FFmpeg 5.1, writes headers of Matroska files that FFmpeg 7.1 writes
/// otherwise. The same video must have the same bytes with either.
inline constexpr bool kHasOldMatroska = LIBAVFORMAT_VERSION_MAJOR < 61;

/// By how much the newer header is larger: a muxer of the older one must leave as much room
/// (AVFormatContext::metadata_header_padding), of which it makes a Void element behind the tags.
inline constexpr int kNewMatroskaBytes = 14;

/// The bytes before the room's end that a longest header has.
inline constexpr std::size_t kMaxMatroskaHeader = std::size_t{1} << 20;

/// `file`, the beginning of a finished Matroska file with one video track and room in its header, as
/// FFmpeg 7.1 writes it: its track has room for HDR metadata that may follow, and its duration in words ends
/// with one zero rather than two. As it is if it has another structure.
[[nodiscard]] std::string with_new_matroska_header(std::string file);

}  // namespace corda::media
