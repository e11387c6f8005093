#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "corda/scene/readers.hpp"

namespace corda::scene {

/// What the bodies of a scene ask for.
struct SceneSize {
    std::vector<std::optional<BodySize>> bodies;  ///< ropes, then nets; empty if not known
    std::optional<std::int64_t> bars;             ///< of all bodies together; empty if not known
    bool fits = true;                             ///< whether there is memory for them
};

/// Counts without making anything. Too many particles or bars of all bodies together are a problem.
[[nodiscard]] SceneSize count_bodies(const Sections& sections, int reach);

/// Adds a problem if the video has no frame or too many, or the simulation would take too many steps or bar
/// updates for that many bars.
void check_work(const Sections& sections, const Scene& scene, std::optional<std::int64_t> bars);

/// For a scene without problems. Adds one if what stretches or bends vibrates so fast that following it to
/// the end takes too many steps, or if speed, gravity or drag are such that exact, rattle or auto would take
/// more than Limits::kFrameUpdates for a frame: no signal and no progress in between.
void check_motion(const Sections& sections, const Scene& scene);

}  // namespace corda::scene
