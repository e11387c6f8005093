#include "corda/sim/exact.hpp"

#include <algorithm>
#include <cassert>

namespace corda::sim {
namespace {

// In parts of the shortest time in which a rope moves by its own length.
constexpr double kFirstStep = 1e-3;
constexpr double kLargestStep = 1.0;
constexpr double kSmallestStep = 1e-14;

/// Errors of steps add up and, in a rope, grow. With this share for a step, positions after some seconds are
/// right to about the tolerance wherever the motion is not chaotic (PHYSICS R5: 1e-13 .. 6e-10 at 1e-9, R1
/// after 2000 s: 1e-6); at 1 it would be 5e-8 and 2e-4. Steps get shorter by its eighth root.
constexpr double kShareOfAStep = 0.01;

/// Below this the estimate sees nothing but rounding.
constexpr double kSmallestTolerance = 1e-15;

StepControl step_control(double rate_1_s, double tolerance) {
    assert(tolerance >= kSmallestTolerance && tolerance <= 1e-2);
    return {std::max(kShareOfAStep * tolerance, kSmallestTolerance), kFirstStep / rate_1_s,
            kLargestStep / rate_1_s, kSmallestStep / rate_1_s};
}

}  // namespace

Exact::Exact(const System& system, const WorldDef& world, const SolverDef& def, double /*frame_interval_s*/)
    : dynamics_(system, world),
      conserves_energy_(world.drag_1_s == 0.0),
      output_(dynamics_.initial_state()),
      integrator_(dynamics_, dynamics_.initial_state(), dynamics_.error_scales(),
                  step_control(dynamics_.largest_rate_1_s(), def.tolerance)) {}

Status Exact::advance_to(double time_s, State& state) {
    if (integrator_.advance_to(time_s) == Status::kDiverged) return Status::kDiverged;
    integrator_.interpolate(time_s, output_.data());
    dynamics_.settle(output_.data());
    state.time_s = time_s;
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

double Exact::energy_j() const {
    return dynamics_.energy_j(output_.data());
}

std::optional<Loads> Exact::loads() const {
    return dynamics_.loads(output_.data());
}

}  // namespace corda::sim
