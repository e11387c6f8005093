#pragma once

#include <string>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::pipeline {

/// A sentence, with a remedy, for everything that a scene gives and its motion does not use as it is given:
/// velocities that its rigid bars cannot have, distances that a string cannot span, velocities of pinned
/// particles, a payload on one, the bending stiffness of a rope without a joint, colours beyond the last
/// link. `plan`: has the method of every body. Throws corda::Error (kInterrupted) if `goes_on` returns false.
[[nodiscard]] std::vector<std::string> input_notes(const Scene& scene, const System& system, const Plan& plan,
                                                   const GoesOn& goes_on = {});

}  // namespace corda::pipeline
