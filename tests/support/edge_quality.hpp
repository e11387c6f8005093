#pragma once

#include <cstdint>

#include "corda/core/image.hpp"

namespace corda::test {

/// Peak signal-to-noise ratio in dB of a mean square: 10 log10(255^2 / mean_square); infinite for 0.
[[nodiscard]] double psnr_db(double mean_square);

/// Structural similarity of two windows of samples 0 .. 255 by their means, variances and covariance:
///
///     (2 mu_a mu_b + c1) (2 s_ab + c2) / ((mu_a^2 + mu_b^2 + c1) (s_a^2 + s_b^2 + c2))
///
/// with c1 = (0.01 * 255)^2, c2 = (0.03 * 255)^2: equation 13 of Z. Wang, A. C. Bovik, H. R. Sheikh,
/// E. P. Simoncelli: Image quality assessment: from error visibility to structural similarity. IEEE
/// Transactions on Image Processing 13(4), 2004, pages 600-612.
[[nodiscard]] constexpr double structural_similarity(double mean_a, double mean_b, double variance_a,
                                                     double variance_b, double covariance) {
    constexpr double kC1 = (0.01 * 255.0) * (0.01 * 255.0);
    constexpr double kC2 = (0.03 * 255.0) * (0.03 * 255.0);
    const double luminance = (2.0 * mean_a * mean_b + kC1) / (mean_a * mean_a + mean_b * mean_b + kC1);
    const double structure = (2.0 * covariance + kC2) / (variance_a + variance_b + kC2);
    return luminance * structure;
}

/// Quality of shown pictures at the edges of drawn bodies. Most of a frame is background, which every encoder
/// keeps, so means over it hardly differ between encoders. Edges are the windows of 8x8 pixels, side by side,
/// in which a channel of the exact picture spans at least 32 levels.
class EdgeQuality {
  public:
    /// Adds a picture; both have the same size. Alpha is ignored.
    void add(const Image& exact, const Image& shown);

    /// Mean squared difference over R, G and B of all edges; 0 if there is none.
    [[nodiscard]] double mean_square() const;
    /// Mean structural similarity (structural_similarity(), with unbiased variances) of the luma of all
    /// edges; 1 if there is none.
    [[nodiscard]] double ssim() const;

  private:
    double squares_ = 0.0;
    double similarities_ = 0.0;
    std::int64_t windows_ = 0;
};

}  // namespace corda::test
