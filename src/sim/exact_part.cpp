#include "corda/sim/exact_part.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace corda::sim {
namespace {

// In parts of the shortest time in which a rope moves by its own length. The first two are for a tolerance of
// 1 and fall with its 16th root: a run and its check at a tolerance a hundred times tighter, which tell the
// error by how far they are apart, must not take the same steps even where nothing else limits these.
constexpr double kFirstStep = 4e-3;
constexpr double kLargestStep = 1.0;
constexpr double kSmallestStep = 1e-14;

/// Errors of steps add up and, in a rope, grow. With this share for a step, positions after some seconds are
/// right to about the tolerance wherever the motion is not chaotic (PHYSICS R5: 1e-13 .. 6e-10 at 1e-9, R1
/// after 2000 s: 1e-6); at 1 it would be 5e-8 and 2e-4. Steps get shorter by its eighth root.
constexpr double kShareOfAStep = 0.01;

/// Below this the estimate sees nothing but rounding.
constexpr double kSmallestTolerance = 1e-15;

}  // namespace

StepControl step_control(double rate_1_s, double tolerance) {
    assert(tolerance >= kSmallestTolerance && tolerance <= 1.0);
    const double pace = std::sqrt(std::sqrt(std::sqrt(std::sqrt(tolerance))));
    return {std::max(kShareOfAStep * tolerance, kSmallestTolerance), pace * kFirstStep / rate_1_s,
            pace * kLargestStep / rate_1_s, kSmallestStep / rate_1_s};
}

OdePart::OdePart(std::unique_ptr<Dynamics> dynamics, double tolerance, bool conserves_energy)
    : dynamics_(std::move(dynamics)),
      conserves_energy_(conserves_energy),
      output_(dynamics_->initial_state()),
      integrator_(*dynamics_, dynamics_->initial_state(), dynamics_->error_scales(),
                  step_control(dynamics_->largest_rate_1_s(), tolerance)) {}

Status OdePart::advance_to(double time_s, State& state) {
    if (integrator_.advance_to(time_s) == Status::kDiverged) return Status::kDiverged;
    integrator_.interpolate(time_s, output_.data());
    dynamics_->settle(output_.data());
    dynamics_->positions(output_.data(), state);
    return Status::kOk;
}

}  // namespace corda::sim
