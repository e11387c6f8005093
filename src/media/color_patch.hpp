#pragma once

#include <array>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/verify.hpp"

namespace corda::media {

/// Side of a colour patch in pixels: one macroblock.
inline constexpr int kPatchSide = 16;

/// Up to five blocks of `frame`, at multiples of 16, that have one colour together with the 8 pixels around
/// them (as far as the frame goes), so that neither deblocking nor the chroma filter mixes in another colour.
/// As many different colours as can be had; corners, centre and edges come first.
[[nodiscard]] std::vector<ColorPatch> choose_patches(const Image& frame);

/// R'G'B' (0 .. 255, not clipped) of BT.709 limited range Y'CbCr: the inverse of convert_to_yuv420.
[[nodiscard]] std::array<double, 3> rgb_from_ycbcr(double y, double cb, double cr);

/// How far, in 1/255, a patch of a sound video may be off at this x264 rate factor.
[[nodiscard]] double patch_tolerance(int crf);

}  // namespace corda::media
