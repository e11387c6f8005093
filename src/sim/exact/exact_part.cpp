#include "corda/sim/exact/exact_part.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace corda::sim {
namespace {

// In parts of the time scale. The first two are for a tolerance of 1 and fall with its 16th root: a run and
// its check at a tolerance a hundred times tighter, whose difference tells the error, must not take the same
// steps even if nothing else limits them.
constexpr double kFirstStep = 4e-3;
constexpr double kMaxStep = 1.0;
constexpr double kMinStep = 1e-14;

/// Errors of steps add up and, in a rope, grow. With this share per step, positions after some seconds are
/// right to about the tolerance unless the motion is chaotic (R5: 1e-13 .. 6e-10 at 1e-9, R1 after 2000 s:
/// 1e-6). With a share of 1 the errors would be 5e-8 and 2e-4. Steps get shorter with its eighth root.
constexpr double kShareOfAStep = 0.01;

/// Of a step: below this the error estimate is rounding alone.
constexpr double kMinShare = 1e-15;

}  // namespace

StepControl step_control(double inverse_timescale_1_s, double tolerance) {
    assert(tolerance >= ExactDef::kMinTolerance && tolerance <= ExactDef::kMaxTolerance);
    const double pace = std::sqrt(std::sqrt(std::sqrt(std::sqrt(tolerance))));
    return {std::max(kShareOfAStep * tolerance, kMinShare), pace * kFirstStep / inverse_timescale_1_s,
            pace * kMaxStep / inverse_timescale_1_s, kMinStep / inverse_timescale_1_s};
}

OdePart::OdePart(std::unique_ptr<Dynamics> dynamics, double tolerance)
    : dynamics_(std::move(dynamics)),
      output_(dynamics_->initial_state()),
      integrator_(*dynamics_, dynamics_->initial_state(), dynamics_->error_scales(),
                  step_control(dynamics_->inverse_timescale_1_s(), tolerance)) {}

Status OdePart::advance_to(double time_s, State& state, StopCheck& stop) {
    if (integrator_.advance_to(time_s, stop) == Status::kDiverged) return Status::kDiverged;
    integrator_.interpolate(time_s, output_.data());
    dynamics_->project(output_.data());
    dynamics_->positions(output_.data(), state);
    return Status::kOk;
}

}  // namespace corda::sim
