#include "corda/sim/exact/chain_part.hpp"

#include <algorithm>
#include <cmath>

namespace corda::sim {
namespace {

/// A step is at most this many times as long as the last one: terms may be small by chance, as at the start
/// of a release from the horizontal.
constexpr double kMaxStepGrowth = 4.0;

/// In parts of the largest step of step_control(): a series of many terms holds for a pendulum's whole swing.
constexpr double kMaxStep = 4.0;

/// The share of the tolerance that the last terms of a step may reach. Errors of steps add up and, in a rope,
/// grow. With this share, positions after some seconds are right to about the tolerance unless the motion is
/// chaotic (R5: 5e-13 .. 2e-10 at 1e-9), and much better if a rope swings gently.
constexpr double kShareOfAStep = 0.0025;

/// The order that meets a tolerance fastest: fewer terms make steps shorter, more make them dearer. Orders
/// are multiples of 4, because these damp quick small oscillations that a step does not resolve; others feed
/// them.
std::size_t order_for(double tolerance) {
    if (tolerance >= 1e-5) return 12;
    return tolerance >= 1e-12 ? 16 : kMaxSeriesOrder;
}

/// Work of a step as a StopCheck counts it: its series take as long as this many updates of a particle.
constexpr std::uint64_t kUpdatesPerLink = 8;

/// Less than a rounding error of the angular velocities, because it bounds the last term alone.
constexpr double kMinTerm = 1e-18;

}  // namespace

ChainPart::ChainPart(const System& system, const Body& body, const Forces& forces, double tolerance)
    : dynamics_(system, {&body, 1}, forces), state_(dynamics_.initial_state()), output_(state_) {
    movers_.reserve(dynamics_.chains().size());
    for (const ChainDynamics::Chain& chain : dynamics_.chains()) {
        StepControl control = step_control(chain.inverse_timescale_1_s, tolerance);
        control.tolerance = std::max(kShareOfAStep * tolerance, kMinTerm);
        control.largest_s *= kMaxStep;
        movers_.push_back({chain, ChainSeries(dynamics_, chain, order_for(tolerance)), control});
    }
}

Status ChainPart::step(Mover& mover, StopCheck& stop) {
    stop.spend(1 + kUpdatesPerLink * mover.chain.link_count);
    const StepControl& control = mover.control;
    const double last_s = mover.end_s - mover.start_s;
    const double unit_s = last_s > 0.0 ? last_s : control.first_s;
    mover.series.expand(state_.data(), unit_s);
    const double longest_step_s = mover.series.longest_step_s(control.tolerance);
    const double largest_s = last_s > 0.0 ? std::min(kMaxStepGrowth * last_s, control.largest_s) : unit_s;
    // Time and step agree to the last bit, so that no rounding of times adds up.
    const double end_s = mover.end_s + std::min(longest_step_s, largest_s);
    const double step_s = end_s - mover.end_s;
    if (!(step_s > control.smallest_s) || mover.steps == StepControl::kMaxSteps) return Status::kDiverged;
    mover.series.evaluate(step_s, state_.data());
    if (mover.chain.ends_pinned) dynamics_.close(mover.chain, state_.data());
    mover.start_s = mover.end_s;
    mover.end_s = end_s;
    ++mover.steps;
    return Status::kOk;
}

Status ChainPart::advance_to(double time_s, State& state, StopCheck& stop) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    for (Mover& mover : movers_) {
        while (mover.end_s < time_s) {
            if (step(mover, stop) == Status::kDiverged) return Status::kDiverged;
        }
        if (mover.steps == 0) continue;  // output_ is the start
        mover.series.evaluate(time_s - mover.start_s, output_.data());
        if (mover.chain.ends_pinned) dynamics_.close(mover.chain, output_.data());
    }
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

std::uint64_t ChainPart::steps() const {
    std::uint64_t steps = 0;
    for (const Mover& mover : movers_) steps += mover.steps;
    return steps;
}

}  // namespace corda::sim
