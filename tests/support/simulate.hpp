#pragma once

#include "corda/sim/simulation.hpp"

namespace corda::test {

/// Method relaxation with its defaults.
inline sim::SolverDef relaxation() {
    sim::SolverDef solver;
    solver.method = sim::Method::kRelaxation;
    return solver;
}

/// A simulation of one rope.
inline sim::Simulation simulate(const sim::RopeDef& rope, const sim::WorldDef& world,
                                const sim::SolverDef& solver) {
    return {sim::build_system({&rope, 1}, solver.reach), world, solver, 1.0 / 60.0};
}

}  // namespace corda::test
