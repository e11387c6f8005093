#pragma once

#include <string>
#include <vector>

#include "corda/scene/scene.hpp"

namespace corda::figures {

/// Whether lines of a colour can be seen on white: a contrast of 2 or more, as WCAG 2.1 defines it.
[[nodiscard]] bool shows_on_white(Color color);

/// Gives a scene that names no theme the paper theme, unless its own ground is dark, or one of its own
/// colours of ropes and nets does not show on white.
void prefer_paper(Scene& scene);

/// The colour of each body in pictures as "#rrggbb", for its curves; all empty, for the colours of plots, if
/// two are the same or one does not show on white. `bodies`: of the system, ascending.
[[nodiscard]] std::vector<std::string> curve_colors(const Scene& scene,
                                                    const std::vector<std::size_t>& bodies);

}  // namespace corda::figures
