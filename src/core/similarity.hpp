#pragma once

namespace corda {

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

}  // namespace corda
