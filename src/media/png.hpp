#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::media {

/// What a PNG says beside its pixels.
struct PngInfo {
    /// tEXt chunks in file order: keyword (1..79 Latin-1 characters) and UTF-8 text.
    std::vector<std::pair<std::string, std::string>> text;
    double pixels_per_inch = 96.0;  ///< written as pHYs; > 0
};

/// Writes `image` as 8-bit PNG with an sRGB and a pHYs chunk; opaque pictures are stored as RGB. The bytes
/// depend on nothing but the arguments. Written beside `path` and renamed when complete, so that no half file
/// is ever seen. Throws corda::Error (kIo).
void write_png(const std::string& path, const Image& image, const PngInfo& info = {});

/// Reads any PNG of at most 16384 x 16384 pixels as 8-bit RGBA. Throws corda::Error (kIo) where there is no
/// such file or it is not a whole PNG.
[[nodiscard]] Image read_png(const std::string& path);

/// The tEXt chunks of a PNG. Throws as read_png.
[[nodiscard]] PngInfo read_png_info(const std::string& path);

}  // namespace corda::media
