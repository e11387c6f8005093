#pragma once

#include <string>

#include "corda/scene/scene.hpp"

namespace corda {

/// A scene file in TOML that says exactly this scene: parse_scene() of it has the same bits, but for what
/// changes no picture (the name, the source, video.jobs). Numbers have as many digits as it takes; straight
/// ropes and grids are written as such, other bodies point by point. Throws corda::Error (kUsage) for a scene
/// that a file cannot say: only code can fill in such a one.
[[nodiscard]] std::string write_scene(const Scene& scene);

}  // namespace corda
