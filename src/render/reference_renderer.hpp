#pragma once

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws a draw list in plain C++. Slow and simple: the oracle that every frame drawn with OpenGL must equal
/// byte for byte.
[[nodiscard]] Image render_reference(const view::DrawList& list);

}  // namespace corda::render
