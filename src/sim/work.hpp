#pragma once

#include "corda/sim/forces/forces.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

// Rough estimates of the work for a scene, from its start alone: good enough to tell minutes from days.

/// Bound on the angular frequency in 1/s of vibrations of a body that stretches or resists bending; 0 for any
/// other body.
[[nodiscard]] double vibration_frequency_1_s(const System& system, const Body& body);

/// Largest angular velocity of a bar of the body at t = 0, in 1/s.
[[nodiscard]] double angular_velocity_1_s(const System& system, const Body& body);

/// Angular frequency in 1/s at which the body's shortest bar swings.
[[nodiscard]] double pendulum_frequency_1_s(const System& system, const Body& body, const Forces& forces);

/// Bound on the angular frequency in 1/s at which the tensions at t = 0 make particles of a body without
/// compliance swing across the links: Gershgorin's, the largest over all particles of 2 w sum of T / l. T
/// pulls what hangs on the link, of all free mass unless a rope is pinned at its first particle alone, as
/// fast as gravity and the link that turns fastest together. 0 if no bar turns or leans, because then none
/// ever will, unless `is_moved_by_rounding`.
[[nodiscard]] double tension_frequency_1_s(const System& system, const Body& body, const Forces& forces,
                                           bool is_moved_by_rounding = false);

/// Steps that an explicit method of high order takes in `time_s` for a motion of this angular frequency.
[[nodiscard]] double expected_steps(double frequency_1_s, double time_s);

/// The same of method rattle where it finds its step itself. For a chain without compliance `frequency_1_s`
/// is that of tension_frequency_1_s(); rattle allows for Rattle::kLoadFactor times the weight.
[[nodiscard]] double expected_rattle_steps(const RattleDef& def, const Body& body, double frequency_1_s,
                                           double time_s);

/// Stages of a step of method rattle.
[[nodiscard]] std::size_t stage_count(const RattleDef& def);

}  // namespace corda::sim
