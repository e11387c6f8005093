#pragma once

#include <cstdint>

#include "corda/core/image.hpp"
#include "corda/media/encode/yuv420.hpp"

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

/// How well shown pictures keep the exact ones where something is drawn: most of a frame is ground, which
/// every encoder keeps, and means over it tell encoders hardly apart. Edges are the windows of 8x8 pixels,
/// side by side, in which a channel of the exact picture spans at least 32 levels.
class EdgeQuality {
  public:
    /// Adds a picture; both have the same size. Alpha is ignored.
    void add(const Image& exact, const Image& shown);

    /// Mean squared difference over R, G and B of all edges; 0 if there is none.
    [[nodiscard]] double mean_square() const;
    /// Mean structural similarity (see luma_ssim) of the luma of all edges; 1 if there is none.
    [[nodiscard]] double ssim() const;

  private:
    double squares_ = 0.0;
    double similarities_ = 0.0;
    std::int64_t windows_ = 0;
};

}  // namespace corda::media
