#pragma once

#include <cstdint>

#include "corda/core/image.hpp"
#include "corda/render/coverage.hpp"
#include "corda/render/ground.hpp"
#include "corda/render/tiles.hpp"

namespace corda::render {

/// What OpenGL has drawn of a layer in a rectangle, whose first pixel the pointers are to.
struct Masks {
    /// Per pixel two bytes: coverage by the capsules and by their halos, 0 .. 255.
    const std::uint8_t* coverage = nullptr;
    const TintSums* sums = nullptr;  ///< of a tinted layer, per pixel; else null
    int row_px = 0;                  ///< from a row to the next
};

/// Paints a layer in `rect`, a part of one of its runs of tiles, as paint_over() and TintSums::mean() say,
/// over colours times alpha.
void paint_run(const PixelRect& rect, Color color, const Masks& masks, const GroundRows& ground,
               Image& image);

}  // namespace corda::render
