#pragma once

#include <cstdint>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::render {

/// Writes row `y` of a ground, `width` pixels of RGBA, colours times alpha, in a frame of `height` rows. In
/// integers: where a colour goes from one level to the next, a fixed pattern of 8 x 8 pixels mixes both.
void write_ground_row(const Ground& ground, int y, int width, int height, std::uint8_t* rgba);

/// Writes a part of a picture of the ground.
void write_ground(const Ground& ground, const PixelRect& part, Image& image);

/// The colours of a ground for a program that mixes them without regard to their alpha, where one that cannot
/// be seen must not show.
[[nodiscard]] Ground straight_ends(const Ground& ground);

}  // namespace corda::render
