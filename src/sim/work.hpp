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

}  // namespace corda::sim
