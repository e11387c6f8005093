#pragma once

#include <string>

namespace corda::media {

/// Whether two PNG files have the same chunks, but for those that change no pixel of read_png(): texts,
/// times, resolutions, colour spaces. Then they show the same, if they can be read. Others may do so too: the
/// same pixels may be packed in several ways. False for files that are no PNG, or are cut off.
[[nodiscard]] bool have_same_picture_chunks(const std::string& a, const std::string& b);

}  // namespace corda::media
