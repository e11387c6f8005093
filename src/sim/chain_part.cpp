#include "corda/sim/chain_part.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

/// A step is no longer than this many times the last: terms may be small by chance, as at the start of a
/// horizontal release.
constexpr double kLargestGrowth = 4.0;

/// Of the largest step of step_control(): a series of many terms is good for a pendulum's whole swing.
constexpr double kLargestStep = 4.0;

/// More steps than this and a run is not coming to an end: a day of computing even for a short rope.
constexpr std::uint64_t kMaxSteps = 1'000'000'000;

/// How a tolerance is met: the order that does it fastest (steps get shorter with fewer terms and dearer with
/// more), and the share of the tolerance that the last terms of a step may reach. Errors of steps add up and,
/// in a rope, grow; with these shares positions after some seconds are right to about the tolerance wherever
/// the motion is not chaotic (PHYSICS R5: 5e-13 .. 2e-10 at 1e-9), and much better where a rope swings
/// gently. Orders are multiples of 4, as series of these damp quick small oscillations that a step does not
/// resolve, where others feed them.
struct Accuracy {
    double least_tolerance;
    std::size_t order;
    double share;
};
constexpr Accuracy kAccuracies[] = {
    {0.3, 4, 0.01}, {1e-2, 8, 0.0025}, {1e-5, 12, 0.0025}, {1e-12, 16, 0.0025}, {0.0, 20, 0.0025}};

/// Lower than a rounding error of the rates, as it counts for the last term alone.
constexpr double kSmallestTerm = 1e-18;

/// From this tolerance on, velocity Verlet steps do for a motion so gentle that every step's correction turns
/// a link by less than this angle times the tolerance: then it is the quick small oscillations that limit the
/// step, and those a Verlet step lives through at the least cost. The source report's swing, 40 particles:
/// 1.7e-5 of the length and 0.44 us a step, where order 4 makes 8.9e-7 with 0.95 us a step of 1.4 times the
/// length.
constexpr double kLeastVerletTolerance = 0.5;
constexpr double kGentleRadians = 1e-3;

/// Of a Verlet step: less than 2 over the largest frequency, and 1 over the drag.
constexpr double kStableOmegaH = 1.9;
constexpr double kStableDragH = 0.5;

/// The root of ChainSeries::square_frequency_1_s2() of a chain with one pin that hangs at rest.
double hanging_frequency_1_s(const ChainDynamics& dynamics, const ChainDynamics::Chain& chain) {
    const Vec2 gravity = dynamics.gravity_m_s2();
    double tension_n = 0.0;
    double stiffness_below_n_m = 0.0;
    double largest_1_s2 = 0.0;
    for (std::size_t i = chain.first_link + chain.link_count; i-- > chain.first_link;) {
        tension_n += length(gravity.x, gravity.y) / dynamics.inverse_mass_1_kg(i);
        const double stiffness_n_m = tension_n / dynamics.length_m(i);
        largest_1_s2 = std::max(largest_1_s2,
                                2.0 * dynamics.inverse_mass_1_kg(i) * (stiffness_n_m + stiffness_below_n_m));
        stiffness_below_n_m = stiffness_n_m;
    }
    return std::sqrt(largest_1_s2);
}

}  // namespace

ChainPart::ChainPart(const System& system, const Body& body, const WorldDef& world, double tolerance)
    : dynamics_(system, {&body, 1}, world),
      conserves_energy_(world.drag_1_s == 0.0),
      state_(dynamics_.initial_state()),
      output_(state_) {
    movers_.reserve(dynamics_.chains().size());
    for (const ChainDynamics::Chain& chain : dynamics_.chains()) {
        const Accuracy& accuracy =
            *std::find_if(std::begin(kAccuracies), std::end(kAccuracies),
                          [&](const Accuracy& row) { return tolerance >= row.least_tolerance; });
        StepControl control = step_control(chain.rate_1_s, tolerance);
        control.tolerance = std::max(accuracy.share * tolerance, kSmallestTerm);
        control.largest_s *= kLargestStep;
        const bool has_one_pin = chain.starts_pinned && !chain.ends_pinned;
        if (tolerance < kLeastVerletTolerance || !has_one_pin) {
            movers_.push_back({chain, ChainSeries(dynamics_, chain, accuracy.order), control});
            continue;
        }
        movers_.push_back({chain, ChainSeries(dynamics_, chain, 1), control});
        movers_.back().gentle_rad = kGentleRadians * tolerance;
        movers_.back().hanging_1_s = hanging_frequency_1_s(dynamics_, chain);
    }
}

double ChainPart::expand(Mover& mover, double last_s, double unit_s) {
    mover.series.expand(state_.data(), unit_s);
    if (mover.series.order() == 1) {
        if (mover.series.correct(last_s) * last_s <= mover.gentle_rad) {
            const double frequency_1_s =
                std::max(mover.hanging_1_s, std::sqrt(mover.series.square_frequency_1_s2()));
            return std::min(kStableOmegaH / frequency_1_s, kStableDragH / dynamics_.drag_1_s());
        }
        mover.series.evaluate(0.0, state_.data());
        mover.series = ChainSeries(dynamics_, mover.chain, kAccuracies[0].order);
        mover.series.expand(state_.data(), unit_s);
    }
    return mover.series.reach_s(mover.control.tolerance);
}

Status ChainPart::step(Mover& mover) {
    const StepControl& control = mover.control;
    const double last_s = mover.end_s - mover.start_s;
    const double unit_s = last_s > 0.0 ? last_s : control.first_s;
    const double reach_s = expand(mover, last_s, unit_s);
    const double largest_s = last_s > 0.0 ? std::min(kLargestGrowth * last_s, control.largest_s) : unit_s;
    // Such that time and step agree to the last bit: no rounding of times adds up.
    const double end_s = mover.end_s + std::min(reach_s, largest_s);
    const double step_s = end_s - mover.end_s;
    if (!(step_s > control.smallest_s) || mover.steps == kMaxSteps) return Status::kDiverged;
    mover.series.evaluate(step_s, state_.data());
    if (mover.chain.ends_pinned) dynamics_.close(mover.chain, state_.data());
    mover.start_s = mover.end_s;
    mover.end_s = end_s;
    ++mover.steps;
    return Status::kOk;
}

Status ChainPart::advance_to(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    for (Mover& mover : movers_) {
        while (mover.end_s < time_s) {
            if (step(mover) == Status::kDiverged) return Status::kDiverged;
        }
        if (mover.steps == 0) continue;  // output_ is the start
        // Rates are wanted with the places where those have to be closed, and otherwise only on request.
        if (mover.chain.ends_pinned) {
            mover.series.evaluate(time_s - mover.start_s, output_.data());
            dynamics_.close(mover.chain, output_.data());
        } else {
            mover.series.evaluate_places(time_s - mover.start_s, output_.data());
        }
    }
    output_s_ = time_s;
    output_is_complete_ = false;
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

const double* ChainPart::output() const {
    if (output_is_complete_) return output_.data();
    for (Mover& mover : movers_) {
        if (mover.steps > 0 && !mover.chain.ends_pinned)
            mover.series.evaluate(output_s_ - mover.start_s, output_.data());
    }
    output_is_complete_ = true;
    return output_.data();
}

std::uint64_t ChainPart::steps() const {
    std::uint64_t steps = 0;
    for (const Mover& mover : movers_) steps += mover.steps;
    return steps;
}

}  // namespace corda::sim
