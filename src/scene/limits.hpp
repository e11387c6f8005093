#pragma once

#include <cstdint>
#include <vector>

#include "corda/scene/readers.hpp"

namespace corda::scene {

/// What the bodies of a scene ask for.
struct SceneSize {
    std::vector<std::int64_t> rope_particles;  ///< one a rope
    std::int64_t bars = 0;                     ///< of all bodies together
};

/// Counts without making anything. Throws kInvalidScene where the particles of all ropes and nets together,
/// or the bars between them, are too many.
[[nodiscard]] SceneSize count_bodies(const Sections& sections, const sim::SolverDef& solver);

/// Throws kInvalidScene where the video has no frame or too many, or the simulation would take too many steps
/// or bar updates for that many bars.
void check_work(const Sections& sections, const Scene& scene, std::int64_t bars);

/// Throws kInvalidScene where what stretches or bends vibrates so fast that following it to the end takes too
/// many steps. For a scene whose bodies have been read.
void check_stiffness(const Sections& sections, const Scene& scene);

/// Throws kInvalidScene where speed, gravity or drag are such that exact, rope or auto would take more than
/// Limits::kFrameUpdates for a frame: no signal and no progress in between. For a scene whose bodies have
/// been read.
void check_pace(const Sections& sections, const Scene& scene);

}  // namespace corda::scene
