#pragma once

#include <numbers>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// Pixels per degree of the field of view for flip(): a screen 0.7 m and 3840 pixels wide, seen
/// from 0.7 m, as in the authors' program.
inline constexpr double kFlipPixelsPerDegree = 3840.0 * std::numbers::pi / 180.0;
/// The least side of pictures that have an ssim().
inline constexpr int kMinSsimSidePx = 11;

/// Mean of LDR-FLIP, the difference that one sees who flips between two sRGB pictures of one size: 0 for
/// equal ones, at most 1. Transparent pictures are laid over black and over white, and the larger figure
/// counts. A pixel that has no differing one within the reach of the filters counts as 0, which it is. The
/// figure does not depend on `threads`, nor on the CPU. 0 for pictures without pixels.
///
/// P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild: FLIP: A difference
/// evaluator for alternating images. Proceedings of the ACM on Computer Graphics and Interactive Techniques
/// 3(2), 2020. Throws corda::Error: kUsage for different sizes, kInterrupted if cancelled.
[[nodiscard]] double flip(const Image& a, const Image& b, int threads = 1,
                          double pixels_per_degree = kFlipPixelsPerDegree);

/// Mean structural similarity of the luma 0.299 R + 0.587 G + 0.114 B of two pictures of one size, over
/// black: at most 1, for equal ones. Windows are Gaussian, of 11x11 pixels and standard deviation 1.5, inside
/// of the picture; K1 = 0.01, K2 = 0.03.
///
/// Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli: Image quality assessment: from error visibility to
/// structural similarity. IEEE Transactions on Image Processing 13(4), 2004, pages 600-612. Throws
/// corda::Error: kUsage for different sizes, and a side below kMinSsimSidePx; kInterrupted.
[[nodiscard]] double ssim(const Image& a, const Image& b);

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
#pragma GCC visibility pop
