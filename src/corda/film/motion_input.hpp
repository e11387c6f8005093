#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/timeline.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::film {

/// The method of each body; std::nullopt if the planner chooses it.
[[nodiscard]] sim::NamedMethods named_methods(const Scene& scene);

/// The methods if each body has one; empty otherwise.
[[nodiscard]] std::vector<MethodDef> if_all_named(const sim::NamedMethods& named);

/// The index of the last frame of a scene; states exist up to it.
[[nodiscard]] std::int64_t last_frame_of(const Scene& scene);

/// A time of a scene's motion in the form of time_within(); std::nullopt if the motion has no state then.
[[nodiscard]] std::optional<double> motion_time_s(const Scene& scene, double time_s);

/// The time of sub-frame `i` of an exposure at `time_s`, clipped to a motion that ends at `end_s`.
[[nodiscard]] double subframe_s(const VideoDef& video, double time_s, double shutter, double end_s, int i);

/// The instants whose arrows set the scale of all, which so does not depend on the frame rate; none without
/// arrows.
[[nodiscard]] std::vector<double> arrow_times_s(const Scene& scene);

/// Validates the input of a motion before anything is computed from it, because the reader of scene files has
/// not checked a scene that is filled in by code. system_of() checks the bodies. Throws corda::Error:
/// kInvalidScene for a definition of the scene, kUsage for a still outside of the motion.
void validate(const Scene& scene, std::span<const double> stills_s);

/// Notes, each a sentence with a remedy, on values of a scene that its motion changes or ignores: velocities
/// along rigid bars, distances that a string cannot span, velocities of pinned particles, a payload on a
/// pinned particle, the bending stiffness of a rope without a joint, colours beyond the last link. `plan` has
/// the method of every body.
[[nodiscard]] std::vector<std::string> input_notes(const Scene& scene, const System& system,
                                                   const Plan& plan);

}  // namespace corda::film
