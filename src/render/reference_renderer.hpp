#pragma once

#include <span>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Draws a draw list in plain C++, slowly and simply. Every frame drawn with OpenGL must equal it byte for
/// byte.
[[nodiscard]] Image render_reference(const view::DrawList& list);

/// Averages the layers of several lists in linear light below the stamps of `list`, whose own layers are
/// ignored.
[[nodiscard]] Image render_reference(std::span<const view::DrawList> exposed, const view::DrawList& list);

}  // namespace corda::render
