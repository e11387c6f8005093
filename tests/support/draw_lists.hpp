#pragma once

#include <cstdint>

#include "corda/view/draw_list.hpp"

namespace corda::test {

/// A list of random capsules in `layer_count` layers of random, partly translucent colours over a ground of
/// two; radii 0.1 to 60 px, halos of up to 9 px, some ends outside of the frame; with `stamps` boxes and
/// texts above them, some cut off. Every n-th layer is tinted (0: none). The same seed gives the same list on
/// every machine.
[[nodiscard]] view::DrawList random_draw_list(std::uint32_t seed, int width, int height,
                                              std::size_t layer_count, std::size_t capsules_per_layer,
                                              std::size_t stamps = 0, std::size_t tinted_every = 0);

/// Contains every pixel that the layers change; within the frame.
[[nodiscard]] PixelRect bounds_of(const view::DrawList& list);

}  // namespace corda::test
