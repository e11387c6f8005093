#pragma once

#include <string>
#include <vector>

namespace corda::media {

/// Whether two PNG files have the same chunks, but for those that change no pixel of read_png(): texts,
/// times, resolutions, colour spaces. Then they show the same, if they can be read. Others may do so too: the
/// same pixels may be packed in several ways. False for files that are no PNG, or are cut off.
[[nodiscard]] bool have_same_picture_chunks(const std::string& a, const std::string& b);

/// The chunks of a PNG file that declare colours other than sRGB, which read_png() ignores: gAMA, cHRM, iCCP
/// and cICP with their values, such as "gAMA (1)". Empty if a chunk of higher precedence declares sRGB (PNG
/// specification, third edition, 4.3), or if the file is not a PNG.
[[nodiscard]] std::vector<std::string> color_chunks_beside_srgb(const std::string& path);

}  // namespace corda::media
