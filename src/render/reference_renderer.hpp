#pragma once

#include <span>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws a draw list in plain C++. Slow and simple: the oracle that every frame drawn with OpenGL must equal
/// byte for byte.
[[nodiscard]] Image render_reference(const view::DrawList& list);

/// The mean of the layers of several lists in linear light under the stamps of `list`, whose own layers are
/// left out.
[[nodiscard]] Image render_reference(std::span<const view::DrawList> exposed, const view::DrawList& list);

}  // namespace corda::render
