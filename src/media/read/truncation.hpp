#pragma once

#include <string>

namespace corda::media {

/// Whether a file of a kind that file_kind() names is shorter than it claims to be: a GIF without its
/// trailer, a PNG without its last chunk, YUV4MPEG2 that ends in a frame, Matroska of a length that is not
/// there. Decoders take what there is and do not tell. False for other kinds. Throws corda::Error (kIo) if it
/// cannot be opened for reading.
[[nodiscard]] bool is_truncated(const std::string& path, const std::string& kind);

}  // namespace corda::media
