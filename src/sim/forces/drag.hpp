#pragma once

#include "corda/sim/defs.hpp"
#include "corda/sim/forces/term.hpp"

namespace corda::sim {

/// Linear drag in still air: velocities alone decay by exp(-drag t).
inline ForceTerm drag(const WorldDef& world) {
    return {{}, world.drag_1_s};
}

}  // namespace corda::sim
