#pragma once

#include "corda/sim/defs.hpp"
#include "corda/sim/forces/term.hpp"

namespace corda::sim {

/// The same acceleration for every mass.
inline ForceTerm gravity(const WorldDef& world) {
    return {world.gravity_m_s2, 0.0};
}

}  // namespace corda::sim
