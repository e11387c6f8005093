#pragma once

#include "corda/core/image.hpp"

namespace corda::serve {

/// A picture made smaller: each pixel is the mean of the area that it covers, by share and alpha. Requires
/// 1 <= width_px <= image.width(), and so for the height.
[[nodiscard]] Image made_smaller(const Image& image, int width_px, int height_px);

}  // namespace corda::serve
