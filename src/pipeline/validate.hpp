#pragma once

#include <optional>
#include <span>

#include "corda/scene/scene.hpp"

namespace corda::pipeline {

/// The number of the last frame of a scene; states exist up to it.
[[nodiscard]] std::int64_t last_frame_of(const Scene& scene);

/// A time of a scene's motion, as time_within() takes it; std::nullopt if the motion has no state then.
[[nodiscard]] std::optional<double> motion_time_s(const Scene& scene, double time_s);

/// Checks what a motion is planned by, before anything is computed from it: a scene that is filled in code
/// has not been checked by the reader of scene files. Its bodies are checked by system_of, what is seen of
/// them by Stage. Throws corda::Error: kInvalidScene for the scene's world, rate, tolerance or
/// body_solvers, kUsage for a still outside of its time.
void validate(const Scene& scene, std::span<const double> stills_s);

}  // namespace corda::pipeline
