#include "plain_rope.hpp"

#include <cmath>
#include <ctime>

#include "corda/sim/exact.hpp"
#include "corda/sim/rattle.hpp"

namespace corda::test {
namespace {

sim::RopeDef plain_rope(int links) {
    sim::RopeDef rope;
    for (int i = 0; i <= links; ++i) {
        const double along_m = std::sqrt(0.5) * i / links;
        rope.points_m.push_back({along_m, -along_m});
    }
    rope.mass_kg.assign(rope.points_m.size(), 1.0);
    rope.velocity_m_s.assign(rope.points_m.size(), {});
    return rope;
}

/// No time where the run diverged.
TimedRun time(sim::Solver& solver, const sim::System& system, double duration_s) {
    sim::State state{0.0, system.x_m, system.y_m};
    const std::clock_t start = std::clock();
    if (solver.advance_to(duration_s, state) != sim::Status::kOk) return {};
    const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    return {taken_s, state.x_m.back(), state.y_m.back()};
}

}  // namespace

TimedRun time_rope(int links, int steps) {
    const sim::RopeDef rope = plain_rope(links);
    const sim::System system = sim::build_system({&rope, 1}, 1);
    sim::Rattle solver(system, sim::WorldDef{}, sim::SolverDef{}, 1.0 / 60.0);
    return time(solver, system, steps * solver.step_s());
}

TimedRun time_exact(int links, double duration_s) {
    const sim::RopeDef rope = plain_rope(links);
    const sim::System system = sim::build_system({&rope, 1}, 1);
    sim::Exact solver(system, sim::WorldDef{}, sim::SolverDef{}, 1.0 / 60.0);
    return time(solver, system, duration_s);
}

}  // namespace corda::test
