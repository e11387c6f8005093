#pragma once

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Paints the parts of a list's stamps that are in `part` over a picture, colours times alpha.
void paint_stamps(const view::DrawList& list, const PixelRect& part, Image& image);

/// Divides the colours of that part by their alpha.
void straighten(const PixelRect& part, Image& image);

}  // namespace corda::render
