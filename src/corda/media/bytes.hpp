#pragma once

#include <string>

#include "corda/core/file.hpp"
#include "corda/media/defs.hpp"

namespace corda::media {

/// The bytes of the file that write_png() writes; with `keeps_alpha`, an opaque picture has alpha, too.
/// Throws corda::Error (kIo, kInterrupted) as that does.
[[nodiscard]] std::string png_bytes(const Image& image, const PngInfo& info, bool keeps_alpha = false);

}  // namespace corda::media
