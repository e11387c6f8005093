#pragma once

#include "corda/media/yuv420.hpp"

namespace corda::media {

/// Mean squared difference of the luma samples, in squared 8-bit steps. Like all functions below, it requires
/// pictures of the same size.
[[nodiscard]] double luma_mean_square(const Yuv420Image& a, const Yuv420Image& b);

/// Peak signal-to-noise ratio in dB of a mean square: 10 log10(255^2 / mean_square); infinite for 0.
[[nodiscard]] double psnr_db(double mean_square);

/// Structural similarity of the luma; at most 1, for equal pictures:
///
///     (2 mu_a mu_b + c1) (2 s_ab + c2) / ((mu_a^2 + mu_b^2 + c1) (s_a^2 + s_b^2 + c2))
///
/// with c1 = (0.01 * 255)^2, c2 = (0.03 * 255)^2 and unbiased variances, averaged over windows of 8x8 equally
/// weighted samples that start at every 4th sample. Requires sides of at least 8. Up to 3 samples at the
/// right and lower edge that these windows do not reach are left out, as in x264 and FFmpeg.
///
/// Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli: Image quality assessment: from error visibility to
/// structural similarity. IEEE Transactions on Image Processing 13(4), 2004, pages 600-612, equation 13.
[[nodiscard]] double luma_ssim(const Yuv420Image& a, const Yuv420Image& b);

}  // namespace corda::media
