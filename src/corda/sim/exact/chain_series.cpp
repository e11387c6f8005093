#include "corda/sim/exact/chain_series.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/exact/chain_closing.hpp"
#include "corda/sim/exact/series_terms.hpp"

namespace corda::sim {
namespace {

// Functions that work on all links are compiled twice: for every CPU, and for AVX2.

using series::kLanes;

/// Unused numbers of a flat array before the first link.
constexpr std::size_t kRoom = 2 * kLanes;

/// Number of last coefficients that determine the length of a step. If a motion is even or odd in time, or
/// both in two perpendicular directions, only every fourth is not zero.
constexpr std::size_t kLastTerms = 4;

using series::Row;

/// Writes the numbers of links i .. i + 3, as far as there are links.
CORDA_INLINE void write_links(const SeriesArrays& a, std::size_t i, const Four& x, double* to) {
    if (i + kLanes <= a.links) {
        any_four(to + i).value = x;
        return;
    }
    // Unrolled, because a loop over lanes would go through memory.
    static_assert(kLanes == 4);
    to[i] = x[0];
    if (i + 1 < a.links) to[i + 1] = x[1];
    if (i + 2 < a.links) to[i + 2] = x[2];
}

/// The sum of the coefficients of w of a block with these weights.
CORDA_INLINE void sum_omegas(SeriesArrays& a, std::size_t b, const Series& weight, Four& sum) {
    const double* coefficient = a.row(b, Row::kOmega, a.order);
    sum = Four{};
    for (std::size_t k = a.order + 1; k-- > 0; coefficient -= kLanes) sum += weight[k] * four(coefficient);
}

/// Writes the angles by which links turn in the time `t`, in units, to load. Returns whether all are small.
CORDA_INLINE bool find_angles(SeriesArrays& a, double t) {
    Series weight;
    double power = 1.0;
    for (std::size_t k = 0; k <= a.order; ++k) {
        weight[k] = a.unit_s * t * power / static_cast<double>(k + 1);
        power *= t;
    }
    Four largest{};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        Four angle;
        sum_omegas(a, b, weight, angle);
        four(a.load + kLanes * b) = angle;
        const Four size = angle > -angle ? angle : -angle;
        largest = size <= largest ? largest : size;  // keeps a NaN
    }
    bool is_small = true;
    for (std::size_t lane = 0; lane < kLanes; ++lane) is_small = is_small && largest[lane] < kSmallAngle;
    return is_small;
}

/// Turns the links by the angles in load and writes their directions.
template <bool kSmall>
CORDA_INLINE void turn(SeriesArrays& a, double* to_c, double* to_s) {
    for (std::size_t i = 0; i < kLanes * a.blocks; i += kLanes) {
        const Four& angle = four(a.load + i);
        const auto [turn_c, turn_s] = kSmall ? cosine_sine_of_small(angle) : cosine_sine(angle);
        const Four c = four(a.c + i) * turn_c - four(a.s + i) * turn_s;
        const Four s = four(a.s + i) * turn_c + four(a.c + i) * turn_s;
        // The inverse length, because the length differs from 1 by rounding alone.
        const Four shrink = 1.5 - 0.5 * (c * c + s * s);
        write_links(a, i, c * shrink, to_c);
        write_links(a, i, s * shrink, to_s);
    }
}

/// Writes the directions at the time `t` in units.
CORDA_INLINE void evaluate_directions(SeriesArrays& a, double t, double* c, double* s) {
    if (find_angles(a, t)) {
        turn<true>(a, c, s);
    } else {
        turn<false>(a, c, s);
    }
}

/// Writes the angular velocities at the time `t` in units.
CORDA_INLINE void evaluate_omegas(SeriesArrays& a, double t, double* omega) {
    Series power;
    power[0] = 1.0;
    for (std::size_t k = 1; k <= a.order; ++k) power[k] = power[k - 1] * t;
    for (std::size_t b = 0; b < a.blocks; ++b) {
        Four sum;
        sum_omegas(a, b, power, sum);
        write_links(a, kLanes * b, sum, omega);
    }
}

/// The largest of all links' coefficients k of w, in size, for k = order - kLastTerms + 1 .. order.
using LastTerms = std::array<double, kLastTerms>;

/// Measures them in parts of `inverse_timescale_1_s` and the angular velocity together.
CORDA_INLINE void measure_last_terms(SeriesArrays& a, double inverse_timescale_1_s, LastTerms& result) {
    Four largest[kLastTerms] = {};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const Four& omega = four(a.row(b, Row::kOmega, 0));
        const Four unit = 1.0 / (inverse_timescale_1_s + (omega > -omega ? omega : -omega));
        const double* coefficient = a.row(b, Row::kOmega, a.order + 1 - kLastTerms);
        for (Four& term : largest) {
            const Four part = four(coefficient) * unit;
            const Four size = part > -part ? part : -part;
            term = size <= term ? term : size;  // keeps a NaN
            coefficient += kLanes;
        }
    }
    for (std::size_t k = 0; k < kLastTerms; ++k) {
        result[k] = 0.0;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            if (!(largest[k][lane] <= result[k])) result[k] = largest[k][lane];
        }
    }
}

/// A function that works on all links, compiled for every CPU and for AVX2.
template <auto kFunction>
struct Compiled;
template <class... Arguments, void (*kFunction)(Arguments...)>
struct Compiled<kFunction> {
    static void narrow(Arguments... arguments) { kFunction(arguments...); }
    CORDA_AVX2 static void wide(Arguments... arguments) { kFunction(arguments...); }
};
using Expand = Compiled<series::expand>;
using EvaluateDirections = Compiled<evaluate_directions>;
using EvaluateOmegas = Compiled<evaluate_omegas>;
using MeasureLastTerms = Compiled<measure_last_terms>;

/// Logarithm to base 2 of x > 0, to 0.09, and its inverse, to 6 %, from the bits of the numbers: the same on
/// every machine.
double rough_log2(double x) {
    return static_cast<double>(std::bit_cast<std::int64_t>(x)) * 0x1p-52 - 1023.0;
}
double rough_exp2(double x) {
    return std::bit_cast<double>(static_cast<std::int64_t>((x + 1023.0) * 0x1p+52));
}

/// Largest ratio of a step to the previous one: terms may be small by chance, as at the start of a release
/// from the horizontal.
constexpr double kMaxStepGrowth = 4.0;

/// In parts of the largest step of step_control(): a series of many terms holds for a pendulum's whole swing.
constexpr double kMaxSeriesStep = 4.0;

/// Share of the tolerance that the last terms of a step may reach: see kShareOfAStep (R5: 5e-13 .. 2e-10 at
/// 1e-9).
constexpr double kShareOfASeriesStep = 0.0025;

/// The fastest order for a tolerance: fewer terms shorten the steps, more make them costlier. Orders are
/// multiples of 4, which damp fast small oscillations that a step does not resolve; others amplify them.
std::size_t order_for(double tolerance) {
    if (tolerance >= 1e-5) return 12;
    return tolerance >= 1e-12 ? 16 : kMaxSeriesOrder;
}

// Where all links of a chain between two pins are in line, as in a parallelogram, its tensions are quotients
// of numbers that vanish, and at an angle a from the line rounding of 1e-16 appears as 1e-16 / a^2. The
// motion itself is smooth, so steps must lead over the line from afar.
constexpr double kNearLine = 3e-3;  ///< spread() of a state that steps should not start from
constexpr double kOnLine = 1e-4;    ///< spread() on the line, in parts of that at the start of a step
constexpr double kOver = 1.3;       ///< a step over the line, in parts of the time to it
constexpr double kShort = 0.6;      ///< a step that cannot lead over the line, in parts of the time to it
/// A step over the line in parts of what the tolerance allows: up to 220 times the error, half the tolerance.
constexpr double kMaxLengthening = 1.4;
constexpr int kSamples = 16;
constexpr int kRefinements = 4;
constexpr double kRefinement = 0.1;

/// Cost of a step per link, in updates of count_work().
constexpr std::uint64_t kUpdatesPerLink = 4;

/// Less than a rounding error of the angular velocities, because it bounds the last term alone.
constexpr double kMinTerm = 1e-18;

}  // namespace

bool has_wide_series() {
#if defined(__x86_64__)
    static const bool has = __builtin_cpu_supports("avx2") != 0;
    return has;
#else
    return false;
#endif
}

struct ChainSeries::Code {
    decltype(&Expand::wide) expand;
    decltype(&EvaluateDirections::wide) evaluate_directions;
    decltype(&EvaluateOmegas::wide) evaluate_omegas;
    decltype(&MeasureLastTerms::wide) measure_last_terms;
};

const ChainSeries::Code& ChainSeries::code_of(bool is_wide) {
    static constexpr Code kNarrow{Expand::narrow, EvaluateDirections::narrow, EvaluateOmegas::narrow,
                                  MeasureLastTerms::narrow};
    static constexpr Code kWide{Expand::wide, EvaluateDirections::wide, EvaluateOmegas::wide,
                                MeasureLastTerms::wide};
    return is_wide ? kWide : kNarrow;
}

ChainSeries::ChainSeries(const Chains& chains, const Chain& chain, std::size_t order, bool is_wide)
    : code_(&code_of(is_wide)),
      start_forces_(&chains.forces_at_start(chain)),
      end_forces_(&chains.forces_at_end(chain)),
      first_link_(chain.first_link),
      link_stride_(chains.link_count()),
      first_extra_(chain.first_extra),
      starts_pinned_(chain.starts_pinned),
      ends_pinned_(chain.ends_pinned),
      inverse_timescale_1_s_(chain.inverse_timescale_1_s),
      length_m_(chain.length_m) {
    assert(order >= kLastTerms && order <= kMaxSeriesOrder);
    SeriesArrays& a = arrays_;
    a.order = order;
    a.links = chain.link_count;
    a.blocks = (a.links + kLanes - 1) / kLanes;
    a.meeting = kLanes * (a.blocks / 2);
    a.drag_1_s = chains.forces.drag_1_s();
    a.first_inverse_mass_1_kg = chain.inverse_mass_1_kg;
    (starts_pinned_ ? a.start_pull_m_s2 : a.fall_m_s2).first = start_forces_->uniform_m_s2();
    if (ends_pinned_) a.end_pull_m_s2.first = end_forces_->uniform_m_s2();
    a.rows.resize(a.blocks * SeriesArrays::kRows * (order + 1));
    double** const arrays[] = {&a.length_m,
                               &a.inverse_length_1_m,
                               &a.inverse_mass_1_kg,
                               &a.c,
                               &a.s,
                               &a.omega,
                               &a.inverse_pivot,
                               &a.weight,
                               &a.load,
                               &a.across_next,
                               &a.across_after,
                               &a.tension,
                               &a.scratch};
    const std::size_t stride = a.blocks + 2 * kRoom / kLanes;
    a.flat.resize(std::size(arrays) * stride);
    for (std::size_t k = 0; k < std::size(arrays); ++k) *arrays[k] = a.flat[k * stride].lane.data() + kRoom;
    for (std::size_t i = 0; i < a.links; ++i) {
        a.length_m[i] = chains.length_m[first_link_ + i];
        a.inverse_length_1_m[i] = 1.0 / a.length_m[i];
        a.inverse_mass_1_kg[i] = chains.inverse_mass_1_kg[first_link_ + i];
    }
}

void ChainSeries::expand(const double* y, double unit_s, double time_s) {
    const double* const c = y + first_link_;
    const double* const s = c + link_stride_;
    const double* const omega = s + link_stride_;
    if (!starts_pinned_) {
        arrays_.x[0] = y[first_extra_];
        arrays_.y[0] = y[first_extra_ + 1];
        arrays_.vx[0] = y[first_extra_ + 2];
        arrays_.vy[0] = y[first_extra_ + 3];
    }
    arrays_.unit_s = unit_s;
    const auto expand_pull = [&](const Forces& forces, SeriesArrays::Pull& pull) {
        if (!forces.depend_on_time()) return;
        pull.changes = arrays_.order;
        forces.expand(time_s, unit_s, pull.term);
        pull.first = pull.term[0];
    };
    expand_pull(*start_forces_, starts_pinned_ ? arrays_.start_pull_m_s2 : arrays_.fall_m_s2);
    if (ends_pinned_) expand_pull(*end_forces_, arrays_.end_pull_m_s2);
    code_->expand(arrays_, c, s, omega);
}

double ChainSeries::longest_step_s(double tolerance) {
    SeriesArrays& a = arrays_;
    LastTerms terms;
    code_->measure_last_terms(a, inverse_timescale_1_s_, terms);
    double shortest = std::numeric_limits<double>::infinity();  // logarithm
    for (std::size_t k = a.order + 1 - kLastTerms; k <= a.order; ++k) {
        double term = terms[k + kLastTerms - a.order - 1];
        if (!starts_pinned_) {
            const double unit_m_s =
                length_m_ * inverse_timescale_1_s_ + std::abs(a.vx[0]) + std::abs(a.vy[0]);
            const double start = std::max(std::abs(a.vx[k]), std::abs(a.vy[k])) / unit_m_s;
            if (!(start <= term)) term = start;
        }
        if (!std::isfinite(term)) return 0.0;
        if (term > 0.0) shortest = std::min(shortest, -rough_log2(term) / static_cast<double>(k));
    }
    if (!std::isfinite(shortest)) return shortest;
    return a.unit_s * rough_exp2(shortest + rough_log2(tolerance) / static_cast<double>(a.order));
}

void ChainSeries::evaluate(double time_s, double* y) {
    const double t = time_s / arrays_.unit_s;
    double* const c = y + first_link_;
    code_->evaluate_directions(arrays_, t, c, c + link_stride_);
    code_->evaluate_omegas(arrays_, t, c + 2 * link_stride_);
    if (starts_pinned_) return;
    y[first_extra_] = sum(arrays_.x, t);
    y[first_extra_ + 1] = sum(arrays_.y, t);
    y[first_extra_ + 2] = sum(arrays_.vx, t);
    y[first_extra_ + 3] = sum(arrays_.vy, t);
}

double ChainSeries::sum(const Series& series, double t) const {
    double value = 0.0;
    for (std::size_t k = arrays_.order + 1; k-- > 0;) value = value * t + series[k];
    return value;
}

ChainPart::ChainPart(const System& system, const Forces& forces, double tolerance)
    : Exact(system, forces, {tolerance}),
      dynamics_(system, system.bodies, forces),
      state_(dynamics_.initial_state()) {
    output_ = state_;
    ahead_ = state_;
    movers_.reserve(dynamics_.chains().list.size());
    for (const Chain& chain : dynamics_.chains().list) {
        StepControl control = step_control(chain.inverse_timescale_1_s, tolerance);
        control.tolerance = std::max(kShareOfASeriesStep * tolerance, kMinTerm);
        control.largest_s *= kMaxSeriesStep;
        movers_.push_back({chain, ChainSeries(dynamics_.chains(), chain, order_for(tolerance)), control});
    }
}

Status ChainPart::step(Mover& mover) {
    count_work(1 + kUpdatesPerLink * mover.chain.link_count);
    const StepControl& control = mover.control;
    const double last_s = mover.end_s - mover.start_s;
    const double unit_s = last_s > 0.0 ? last_s : control.first_s;
    mover.series.expand(state_.data(), unit_s, mover.end_s);
    const double longest_step_s = mover.series.longest_step_s(control.tolerance);
    const double largest_s = last_s > 0.0 ? std::min(kMaxStepGrowth * last_s, control.largest_s) : unit_s;
    // Time and step agree to the last bit, so that no rounding of times adds up.
    double wanted_s = std::min(longest_step_s, largest_s);
    if (mover.chain.ends_pinned) wanted_s = past_line(mover, wanted_s);
    const double key_s = dynamics_.chains().next_key_s(mover.chain, mover.end_s);
    wanted_s = StepControl::step_before_key(wanted_s, key_s - mover.end_s);
    const double end_s = mover.end_s + wanted_s;
    const double step_s = end_s - mover.end_s;
    if (!(step_s > control.smallest_s) || mover.steps == StepControl::kMaxSteps) return Status::kDiverged;
    mover.series.evaluate(step_s, state_.data());
    if (mover.chain.ends_pinned) close_between_pins(dynamics_.chains(), mover.chain, end_s, state_.data());
    mover.start_s = mover.end_s;
    mover.end_s = end_s;
    ++mover.steps;
    return Status::kOk;
}

double ChainPart::past_line(Mover& mover, double step_s) {
    const auto spread = [&](double time_s) {
        mover.series.evaluate(time_s, ahead_.data());
        return sim::spread(dynamics_.chains(), mover.chain, ahead_.data());
    };
    if (!(spread(step_s) < kNearLine)) return step_s;
    const double longest_s = std::max(kMaxLengthening * step_s, mover.end_s - mover.start_s);
    const double part_s = kMaxLengthening * longest_s / kSamples;
    double before = spread(0.0);
    const double start = before;
    double here = spread(part_s);
    double after = 0.0;
    double time_s = part_s;
    for (int k = 2; k <= kSamples; ++k, time_s += part_s, before = here, here = after) {
        after = spread(time_s + part_s);
        if (here < before && here <= after) break;
    }
    if (!(here < before && here <= after)) return step_s;
    // Near a line, the spread is a parabola.
    double width_s = part_s;
    for (int k = 0; k < kRefinements; ++k, width_s *= kRefinement) {
        const double low = spread(time_s - width_s);
        const double high = spread(time_s + width_s);
        time_s += 0.5 * width_s * (low - high) / (low - 2.0 * spread(time_s) + high);
    }
    if (!(time_s > 0.0 && spread(time_s) < kOnLine * start)) return step_s;
    if (kOver * time_s <= longest_s) return std::max(step_s, kOver * time_s);
    return std::min(step_s, kShort * time_s);
}

Status ChainPart::reach(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    for (Mover& mover : movers_) {
        while (mover.end_s < time_s) {
            if (step(mover) == Status::kDiverged) return Status::kDiverged;
        }
        if (mover.steps == 0) continue;  // output_ is the start
        mover.series.evaluate(time_s - mover.start_s, output_.data());
        if (mover.chain.ends_pinned)
            close_between_pins(dynamics_.chains(), mover.chain, time_s, output_.data());
    }
    dynamics_.set_time(time_s);
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

std::uint64_t ChainPart::steps() const {
    std::uint64_t steps = 0;
    for (const Mover& mover : movers_) steps += mover.steps;
    return steps;
}

}  // namespace corda::sim
