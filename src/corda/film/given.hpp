#pragma once

#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::film {

/// Checks that the given motion of a scene fits it: one position per particle, up to the last frame. Throws
/// corda::Error (kUsage), and kInvalidScene for pictures that show tensions.
void validate_given(const Scene& scene);

/// Gives the system of a scene the start of its given motion, in world coordinates. Pins that this moves have
/// moves, though empty ones: their supports follow them.
void start_as_given(const GivenMotion& given, System& system);

/// The state of a given motion at a time, without the fields that are not asked for. Tensions are NaN.
[[nodiscard]] State given_state(const GivenMotion& given, double time_s, const System& system,
                                const StateFields& fields);

/// The figures that follow from the positions of a state: the largest strain.
[[nodiscard]] Figures given_figures(const System& system, const State& state);

}  // namespace corda::film
