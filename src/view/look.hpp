#pragma once

#include <vector>

#include "corda/view/defs.hpp"

namespace corda::view {

/// The colours of a scene: its style's, and its theme's for what that does not give.
struct Look {
    Ground ground;
    std::vector<Color> palette;
    Color support;  ///< of what does not move: plates and rings
    Color outline;  ///< of balls
    Color pinned;
    Color free;
    Color real_bar;
    Color imaginary_bar;
};

[[nodiscard]] Look look_of(const StyleDef& style);

/// One that can be read on the ground; on what shows through a ground, the theme's.
[[nodiscard]] Color text_color(const Look& look);

}  // namespace corda::view
