#pragma once

#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/render/coverage.hpp"
#include "corda/render/ground.hpp"
#include "corda/render/tiles.hpp"

namespace corda::render {

/// What OpenGL has drawn of layers in some rectangles, one after the other, each row by row.
struct Masks {
    /// Per pixel two bytes: coverage by the capsules and by their halos, 0 .. 255.
    std::vector<std::uint8_t> coverage;
    std::vector<TintSums> sums;  ///< of tinted layers, per pixel; else empty
};

/// Paints a layer in `rect`, a part of one of its runs of tiles, as paint_over() and TintSums::mean() say,
/// over colours times alpha. The masks of `rect` begin at pixel `first`. Returns where they end.
std::size_t paint_run(const PixelRect& rect, Color color, const Masks& masks, std::size_t first,
                      const GroundRows& ground, Image& image);

}  // namespace corda::render
