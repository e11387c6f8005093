#pragma once

#include <cstdint>

#include "corda/core/image.hpp"

namespace corda::test {

/// Peak signal-to-noise ratio in dB of a mean square: 10 log10(255^2 / mean_square); infinite for 0.
[[nodiscard]] double psnr_db(double mean_square);

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
