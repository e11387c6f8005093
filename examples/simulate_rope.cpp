// The simulation alone: no scene file, no graphics. Prints the tip of a hanging rope that was let go at 30
// degrees.
//
//   x_next = x + (1 - delta) (x - x_previous) + h^2 f / m, then every bar is pushed back to its length
//
// Start: a straight rope of 1 m at rest. Conserved, but for what the method itself loses: the energy.

#include <cmath>
#include <cstdio>
#include <numbers>

#include "corda/sim/simulation.hpp"

int main() {
    constexpr int kLinks = 10;
    constexpr double kAngle = 30.0 * std::numbers::pi / 180.0;
    corda::sim::RopeDef rope;
    for (int i = 0; i <= kLinks; ++i) {
        const double along_m = static_cast<double>(i) / kLinks;
        rope.points_m.push_back({along_m * std::sin(kAngle), -along_m * std::cos(kAngle)});
        rope.mass_kg.push_back(0.1);
        rope.velocity_m_s.push_back({0.0, 0.0});
    }
    corda::sim::WorldDef world;
    corda::sim::SolverDef solver;
    solver.method = corda::sim::Method::kRelaxation;
    solver.step_s = 1e-3;
    solver.reach = 1;
    solver.sweeps = 100;
    corda::sim::Simulation simulation(corda::sim::build_system({&rope, 1}, solver.reach), world, solver, 0.1);
    for (int k = 0; k <= 20; ++k) {
        if (simulation.advance_to(0.1 * k) == corda::sim::Status::kDiverged) return 1;
        const corda::sim::State& state = simulation.state();
        std::printf("t %.1f s  tip (%+.4f, %+.4f) m\n", state.time_s, state.x_m.back(), state.y_m.back());
    }
    std::printf("energy error %.2e of M g L\n", simulation.diagnostics().largest.energy_error.value_or(0.0));
    return 0;
}
