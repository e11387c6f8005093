#pragma once

#include <string>
#include <vector>

#include "corda/media/defs.hpp"

namespace corda::media {

// The public functions read_png() and write_png() are declared in defs.hpp.

/// The bytes of the file that write_png() writes; with `keeps_alpha`, an opaque picture has alpha, too.
/// Throws corda::Error (kIo, kInterrupted) as that does.
[[nodiscard]] std::string png_bytes(const Image& image, const PngInfo& info, bool keeps_alpha = false);

/// True if two PNG files have the same chunks, except those that change no pixel of read_png(): texts,
/// times, resolutions, colour spaces. Then they show the same, if they can be read. Others may do so too: the
/// same pixels may be packed in several ways. False for files that are no PNG, or are cut off.
[[nodiscard]] bool have_same_picture_chunks(const std::string& path_a, const std::string& path_b);

/// The chunks of a PNG file that declare colours other than sRGB, which read_png() ignores: gAMA, cHRM, iCCP
/// and cICP with their values, such as "gAMA (1)". Empty if a chunk of higher precedence declares sRGB (PNG
/// specification, third edition, 4.3), or if the file is not a PNG.
[[nodiscard]] std::vector<std::string> color_chunks_beside_srgb(const std::string& path);

}  // namespace corda::media
