#pragma once

#include <string>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::test {

/// A video of any format as RGBA, read independently of corda::media.
struct DecodedRgba {
    std::vector<double> times_s;
    std::vector<Image> pictures;
};

/// Decodes all frames by the program ffmpeg, which also converts the colours, VP9 with its alpha.
/// Throws std::runtime_error on any error.
[[nodiscard]] DecodedRgba decode_rgba(const std::string& path);

}  // namespace corda::test
