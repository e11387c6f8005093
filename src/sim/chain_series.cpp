#include "corda/sim/chain_series.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "corda/sim/four.hpp"
#include "corda/sim/series_terms.hpp"

namespace corda::sim {
namespace {

// Functions that work on all links are compiled twice: for any x86-64 and for registers of four numbers.
#if defined(__x86_64__)
#define CORDA_WIDE [[gnu::target("avx2")]]
bool has_wide_registers() {
    return __builtin_cpu_supports("avx2") != 0;
}
#else
#define CORDA_WIDE
bool has_wide_registers() {
    return false;
}
#endif

using series::kLanes;

/// Numbers of a flat array before the first link's.
constexpr std::size_t kRoom = 2 * kLanes;

/// As in ChainDynamics: far below all that can be seen, and set to zero before it gets denormal.
constexpr double kNegligible = 1e-60;

/// The last coefficients that a step follows from. Where a motion is even or odd in time, or both in two
/// directions at right angles, all but every fourth are zero.
constexpr std::size_t kLastTerms = 4;

using series::Row;

/// Directions and rates at the time `t` in units, to load, load_before and scratch.
CORDA_INLINE void evaluate_series(SeriesArrays& a, double t) {
    Series power;
    Series integral;
    power[0] = 1.0;
    for (std::size_t k = 0; k <= a.order; ++k) {
        if (k > 0) power[k] = power[k - 1] * t;
        integral[k] = a.unit_s * t * power[k] / static_cast<double>(k + 1);
    }
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const double* coefficient = a.row(b, Row::kRate, a.order);
        Four angle{};
        Four rate{};
        for (std::size_t k = a.order + 1; k-- > 0; coefficient -= kLanes) {
            angle += integral[k] * four(coefficient);
            rate += power[k] * four(coefficient);
        }
        Four turn_c;
        Four turn_s;
        cosine_sine(angle, turn_c, turn_s);
        const Four c = four(a.c + i) * turn_c - four(a.s + i) * turn_s;
        const Four s = four(a.s + i) * turn_c + four(a.c + i) * turn_s;
        // The inverse of a length that differs from 1 by rounding.
        const Four shrink = 1.5 - 0.5 * (c * c + s * s);
        four(a.load + i) = c * shrink;
        four(a.load_before + i) = s * shrink;
        four(a.scratch + i) = rate;
    }
}

/// Coefficients k of the rates with the largest size, k = order - kLastTerms + 1 .. order.
using LastTerms = std::array<double, kLastTerms>;

/// In parts of `rate_1_s` and the rate itself.
CORDA_INLINE void measure_last_terms(SeriesArrays& a, double rate_1_s, LastTerms& result) {
    Four largest[kLastTerms] = {};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const Four& rate = four(a.row(b, Row::kRate, 0));
        const Four unit = 1.0 / (rate_1_s + (rate > -rate ? rate : -rate));
        const double* coefficient = a.row(b, Row::kRate, a.order + 1 - kLastTerms);
        for (Four& term : largest) {
            const Four part = four(coefficient) * unit;
            const Four size = part > -part ? part : -part;
            term = size <= term ? term : size;  // keeps what is not a number
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

CORDA_WIDE void expand_wide(SeriesArrays& a) {
    series::expand(a);
}
void expand_narrow(SeriesArrays& a) {
    series::expand(a);
}
CORDA_WIDE void evaluate_wide(SeriesArrays& a, double t) {
    evaluate_series(a, t);
}
void evaluate_narrow(SeriesArrays& a, double t) {
    evaluate_series(a, t);
}
CORDA_WIDE void measure_last_terms_wide(SeriesArrays& a, double rate_1_s, LastTerms& result) {
    measure_last_terms(a, rate_1_s, result);
}
void measure_last_terms_narrow(SeriesArrays& a, double rate_1_s, LastTerms& result) {
    measure_last_terms(a, rate_1_s, result);
}

/// Logarithm to the base 2 of x > 0 and its inverse, to 0.09 and 6 %, from the bits as they are: the same
/// everywhere.
double rough_log2(double x) {
    return static_cast<double>(std::bit_cast<std::int64_t>(x)) * 0x1p-52 - 1023.0;
}
double rough_exp2(double x) {
    return std::bit_cast<double>(static_cast<std::int64_t>((x + 1023.0) * 0x1p+52));
}

}  // namespace

ChainSeries::ChainSeries(const ChainDynamics& dynamics, const ChainDynamics::Chain& chain, std::size_t order)
    : first_link_(chain.first_link),
      link_stride_(dynamics.link_count()),
      first_extra_(chain.first_extra),
      starts_pinned_(chain.starts_pinned),
      rate_1_s_(chain.rate_1_s),
      length_m_(chain.length_m) {
    assert(order >= kLastTerms && order <= kLargestSeriesOrder);
    SeriesArrays& a = arrays_;
    a.order = order;
    a.links = chain.link_count;
    a.blocks = (a.links + kLanes - 1) / kLanes;
    a.meeting = kLanes * (a.blocks / 2);
    a.drag_1_s = dynamics.drag_1_s();
    a.first_inverse_mass_1_kg = chain.inverse_mass_1_kg;
    const Vec2 gravity = dynamics.gravity_m_s2();
    if (chain.starts_pinned) a.start_pull_m_s2 = gravity;
    if (chain.ends_pinned) a.end_pull_m_s2 = gravity;
    if (!chain.starts_pinned) a.fall_m_s2 = gravity;
    a.rows.resize(a.blocks * SeriesArrays::kRows * (order + 1));
    double** const arrays[] = {&a.length_m,
                               &a.inverse_length_1_m,
                               &a.inverse_mass_1_kg,
                               &a.c,
                               &a.s,
                               &a.rate,
                               &a.inverse_pivot,
                               &a.weight,
                               &a.load,
                               &a.load_before,
                               &a.across_before,
                               &a.across_after,
                               &a.tension,
                               &a.scratch};
    const std::size_t stride = a.blocks + 2 * kRoom / kLanes;
    a.flat.resize(std::size(arrays) * stride);
    for (std::size_t k = 0; k < std::size(arrays); ++k) *arrays[k] = a.flat[k * stride].lane.data() + kRoom;
    for (std::size_t i = 0; i < a.links; ++i) {
        a.length_m[i] = dynamics.length_m(first_link_ + i);
        a.inverse_length_1_m[i] = 1.0 / a.length_m[i];
        a.inverse_mass_1_kg[i] = dynamics.inverse_mass_1_kg(first_link_ + i);
    }
}

void ChainSeries::expand(const double* y, double unit_s) {
    const double* const c = y + first_link_;
    const double* const s = c + link_stride_;
    const double* const rate = s + link_stride_;
    const auto keep = [](double value) { return std::abs(value) < kNegligible ? 0.0 : value; };
    for (std::size_t i = 0; i < arrays_.links; ++i) {
        arrays_.c[i] = keep(c[i]);
        arrays_.s[i] = keep(s[i]);
        arrays_.rate[i] = keep(rate[i]);
    }
    if (!starts_pinned_) {
        arrays_.x[0] = y[first_extra_];
        arrays_.y[0] = y[first_extra_ + 1];
        arrays_.vx[0] = y[first_extra_ + 2];
        arrays_.vy[0] = y[first_extra_ + 3];
    }
    arrays_.unit_s = unit_s;
    static const bool is_wide = has_wide_registers();
    if (is_wide) {
        expand_wide(arrays_);
    } else {
        expand_narrow(arrays_);
    }
}

double ChainSeries::reach_s(double tolerance) {
    static const bool is_wide = has_wide_registers();
    SeriesArrays& a = arrays_;
    LastTerms terms;
    if (is_wide) {
        measure_last_terms_wide(a, rate_1_s_, terms);
    } else {
        measure_last_terms_narrow(a, rate_1_s_, terms);
    }
    double shortest = std::numeric_limits<double>::infinity();  // logarithm
    for (std::size_t k = a.order + 1 - kLastTerms; k <= a.order; ++k) {
        double term = terms[k + kLastTerms - a.order - 1];
        if (!starts_pinned_) {
            const double unit_m_s = length_m_ * rate_1_s_ + std::abs(a.vx[0]) + std::abs(a.vy[0]);
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
    static const bool is_wide = has_wide_registers();
    SeriesArrays& a = arrays_;
    const double t = time_s / a.unit_s;
    if (is_wide) {
        evaluate_wide(a, t);
    } else {
        evaluate_narrow(a, t);
    }
    double* const c = y + first_link_;
    std::copy_n(a.load, a.links, c);
    std::copy_n(a.load_before, a.links, c + link_stride_);
    std::copy_n(a.scratch, a.links, c + 2 * link_stride_);
    if (starts_pinned_) return;
    const auto sum = [&](const Series& series) {
        double value = 0.0;
        for (std::size_t k = a.order + 1; k-- > 0;) value = value * t + series[k];
        return value;
    };
    y[first_extra_] = sum(a.x);
    y[first_extra_ + 1] = sum(a.y);
    y[first_extra_ + 2] = sum(a.vx);
    y[first_extra_ + 3] = sum(a.vy);
}

}  // namespace corda::sim
