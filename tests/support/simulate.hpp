#pragma once

#include "corda/sim/simulation.hpp"

namespace corda::test {

/// A simulation of one rope.
inline Simulation simulate(const RopeDef& rope, const WorldDef& world, const MethodDef& method) {
    return {build_system({&rope, 1}), world, method};
}

}  // namespace corda::test
