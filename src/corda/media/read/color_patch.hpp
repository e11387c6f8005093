#pragma once

#include <array>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Side of a colour patch in pixels: one macroblock.
inline constexpr int kPatchSide = 16;

/// Up to five blocks of `frame`, at multiples of 16, without an edge in them or in the 8 pixels around them
/// (as far as the frame goes), so that neither deblocking nor the chroma filter mixes in another colour. A
/// ground that changes slowly has no edges. Blocks of different colours are preferred; then those in corners,
/// in the centre and at the sides.
[[nodiscard]] std::vector<ColorPatch> choose_patches(const Image& frame);

/// Mean R'G'B' of the block at (x, y), which lies within the frame.
[[nodiscard]] std::array<double, 3> mean_rgb(const Image& frame, int x, int y);

/// True if all of a patch is within a picture of this size.
[[nodiscard]] constexpr bool is_within(const ColorPatch& patch, int width_px, int height_px) {
    return patch.x >= 0 && patch.y >= 0 && patch.x <= width_px - kPatchSide &&
           patch.y <= height_px - kPatchSide;
}

/// The largest difference of a channel between shown R'G'B' and a patch, in 1/255.
[[nodiscard]] double patch_error(const ColorPatch& patch, const std::array<double, 3>& shown);

/// The largest error that a patch of a correct video may have at this x264 rate factor; more with chroma in
/// full resolution (4:4:4).
[[nodiscard]] double patch_tolerance(int crf, bool has_full_chroma = false);

}  // namespace corda::media
