#pragma once

#include <array>

#include "corda/core/image.hpp"
#include "support/yuv420_image.hpp"

namespace corda::test {

/// R'G'B' (0..255, not rounded) of the BT.709 limited-range picture at pixel (x, y), in double precision.
[[nodiscard]] std::array<double, 3> rgb_at(const Yuv420Image& picture, int x, int y);

/// Peak signal-to-noise ratio of the luma planes in dB: the decoded picture's against the rendered one's,
/// computed in double precision and rounded to 8 bits.
[[nodiscard]] double luma_psnr_db(const Yuv420Image& decoded, const Image& rendered);

}  // namespace corda::test
