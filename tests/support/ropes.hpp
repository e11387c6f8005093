#pragma once

#include <cmath>
#include <numbers>

#include "corda/sim/simulation.hpp"

namespace corda::test {

/// `links` + 1 unit masses in a straight line of `length_m` from the origin, at `angle_deg` from straight
/// down towards +x, at rest; the first one pinned.
inline sim::RopeDef straight_rope(int links, double length_m, double angle_deg) {
    sim::RopeDef rope;
    const double angle = angle_deg * std::numbers::pi / 180.0;
    for (int i = 0; i <= links; ++i) {
        const double along_m = i * length_m / links;
        rope.points_m.push_back({along_m * std::sin(angle), -along_m * std::cos(angle)});
    }
    rope.mass_kg.assign(rope.points_m.size(), 1.0);
    rope.velocity_m_s.assign(rope.points_m.size(), {});
    return rope;
}

/// The source report's start: a line of `particles` unit masses with step (0.1, -1), the first one pinned.
inline sim::RopeDef report_rope(int particles) {
    sim::RopeDef rope;
    for (int i = 0; i < particles; ++i) rope.points_m.push_back({0.1 * i, -1.0 * i});
    rope.mass_kg.assign(rope.points_m.size(), 1.0);
    rope.velocity_m_s.assign(rope.points_m.size(), {});
    return rope;
}

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
