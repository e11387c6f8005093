#include "corda/sim/chain_series.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

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
#define CORDA_INLINE [[gnu::always_inline]] inline

constexpr std::size_t kLanes = kSeriesLanes;
using Four [[gnu::vector_size(kLanes * sizeof(double)), gnu::may_alias]] = double;
using FourBits [[gnu::vector_size(kLanes * sizeof(double)), gnu::may_alias]] = long long;
/// At any address.
using AnyFour [[gnu::vector_size(kLanes * sizeof(double)), gnu::may_alias, gnu::aligned(sizeof(double))]] =
    double;

// References, as the way in which such a type is passed by value depends on the CPU.
CORDA_INLINE const Four& four(const double* x) {
    return *reinterpret_cast<const Four*>(x);
}
CORDA_INLINE Four& four(double* x) {
    return *reinterpret_cast<Four*>(x);
}
CORDA_INLINE const AnyFour& any_four(const double* x) {
    return *reinterpret_cast<const AnyFour*>(x);
}
CORDA_INLINE AnyFour& any_four(double* x) {
    return *reinterpret_cast<AnyFour*>(x);
}

/// Numbers of a flat array before the first link's.
constexpr std::size_t kRoom = 2 * kLanes;

/// Fractions are rescaled, by a power of two and so without rounding, before they grow out of range.
constexpr double kLargeFraction = 0x1p+300;
constexpr double kSmallFraction = 0x1p-300;

/// As in ChainDynamics: far below all that can be seen, and set to zero before it gets denormal.
constexpr double kNegligible = 1e-60;

/// The last coefficients that a step follows from. Where a motion is even or odd in time, or both in two
/// directions at right angles, all but every fourth are zero.
constexpr std::size_t kLastTerms = 4;

using Row = SeriesArrays::Row;

/// Directions, rates and turns at t = 0.
CORDA_INLINE void start_series(SeriesArrays& a) {
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& c = four(a.c + i);
        const Four& s = four(a.s + i);
        const AnyFour& next_c = any_four(a.c + i + 1);
        const AnyFour& next_s = any_four(a.s + i + 1);
        const Four& inverse_mass = four(a.inverse_mass_1_kg + i);
        const Four sine = inverse_mass * (c * next_s - s * next_c);
        four(a.row(b, Row::kCosine, 0)) = inverse_mass * (c * next_c + s * next_s);
        four(a.row(b, Row::kSine, 0)) = sine;
        four(a.scratch + i) = sine * sine;
        four(a.row(b, Row::kRate, 0)) = four(a.rate + i);
        four(a.row(b, Row::kTurn, 0)) = any_four(a.rate + i + 1) - four(a.rate + i);
    }
}

/// P and Q of ChainDynamics on the way from one end to the middle.
struct Fraction {
    double p;
    double q = 1.0;
    /// Writes Q to `q_here` and the pivot times Q to `divisor`, and goes on past the joint of a particle of
    /// this inverse mass; `sine2` is (W S)^2.
    CORDA_INLINE void pass(double inverse_mass, double sine2, double& q_here, double& divisor) {
        const double d = p + inverse_mass * q;
        q_here = q;
        divisor = d;
        p = inverse_mass * p + sine2 * q;
        q = d;
        if (q > kLargeFraction || q < kSmallFraction) {
            const double scale = q > 1.0 ? kSmallFraction : kLargeFraction;
            p *= scale;
            q *= scale;
        }
    }
};

/// Factorises the matrix of the tensions: inverse pivots and weights.
CORDA_INLINE void factorise(SeriesArrays& a) {
    double* const q = a.load;
    double* const divisor = a.across_after;
    std::size_t high = a.links - 1;
    std::size_t low = 0;
    Fraction from_end{a.inverse_mass_1_kg[high]};
    Fraction from_start{a.first_inverse_mass_1_kg};
    while (high > a.meeting || low < a.meeting) {
        if (high > a.meeting) {
            from_end.pass(a.inverse_mass_1_kg[high - 1], a.scratch[high - 1], q[high], divisor[high]);
            --high;
        }
        if (low < a.meeting) {
            from_start.pass(a.inverse_mass_1_kg[low], a.scratch[low], q[low], divisor[low]);
            ++low;
        }
    }
    q[a.meeting] = from_start.q * from_end.q;
    divisor[a.meeting] = from_start.p * from_end.q + from_end.p * from_start.q;
    for (std::size_t i = a.links; i < kLanes * a.blocks; ++i) {
        q[i] = 0.0;
        divisor[i] = 1.0;
    }
    for (std::size_t i = 0; i < kLanes * a.blocks; i += kLanes) {
        four(a.inverse_pivot + i) = four(q + i) / four(divisor + i);
    }
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const bool is_low = i < a.meeting;
        four(a.weight + i) =
            four(a.row(b, Row::kCosine, 0)) * any_four(a.inverse_pivot + i + (is_low ? 0 : 1));
    }
}

/// Terms of coefficient k of a block's loads and pulls across that do not need the tensions' coefficient k.
CORDA_INLINE void known_terms(SeriesArrays& a, std::size_t b, std::size_t k) {
    const double* cosine = a.row(b, Row::kCosine, 0);
    const double* sine = a.row(b, Row::kSine, 0);
    const double* tension = a.row(b, Row::kTension, k);
    const double* next_tension = a.row(b, Row::kNextTension, k);
    Four load_next{};
    Four load{};
    Four across_next{};
    Four across{};
    for (std::size_t j = 1; j <= k; ++j) {
        cosine += kLanes;
        sine += kLanes;
        tension -= kLanes;
        next_tension -= kLanes;
        load_next += four(cosine) * four(tension);
        load += four(cosine) * four(next_tension);
        across_next += four(sine) * four(tension);
        across += four(sine) * four(next_tension);
    }
    const double* rate = a.row(b, Row::kRate, 0);
    const double* last_rate = a.row(b, Row::kRate, k);
    Four square{};
    for (; rate < last_rate; rate += kLanes, last_rate -= kLanes) square += four(rate) * four(last_rate);
    square += square;
    if (rate == last_rate) square += four(rate) * four(rate);
    const std::size_t i = kLanes * b;
    any_four(a.load_before + i + 1) = load_next;
    four(a.load + i) = four(a.length_m + i) * square + load;
    any_four(a.across_before + i + 1) = across_next;
    four(a.across_after + i) = across;
}

/// Coefficient k + 1 of the joints' cosines and sines.
CORDA_INLINE void turn_joints(SeriesArrays& a, std::size_t b, std::size_t k, double share) {
    const double* turn = a.row(b, Row::kTurn, 0);
    const double* cosine = a.row(b, Row::kCosine, k);
    const double* sine = a.row(b, Row::kSine, k);
    Four to_cosine{};
    Four to_sine{};
    for (std::size_t j = 0; j <= k; ++j) {
        to_cosine += four(turn) * four(sine);
        to_sine += four(turn) * four(cosine);
        turn += kLanes;
        cosine -= kLanes;
        sine -= kLanes;
    }
    four(a.row(b, Row::kCosine, k + 1)) = -share * to_cosine;
    four(a.row(b, Row::kSine, k + 1)) = share * to_sine;
}

/// A block's elimination towards lower links; `last` is the load of the link above.
CORDA_INLINE void eliminate_down(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    four(a.load + first) += four(a.load_before + first);
    for (std::size_t i = first + kLanes; i-- > std::max(first, a.meeting + 1);) {
        last = a.load[i] + a.weight[i] * last;
        a.load[i] = last;
    }
}

/// The same towards higher links, from a block below the meeting.
CORDA_INLINE void eliminate_up(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    four(a.load + first) += four(a.load_before + first);
    for (std::size_t i = first; i < first + kLanes; ++i) {
        last = a.load[i] + (a.weight + i)[-1] * last;
        a.load[i] = last;
    }
}

/// Coefficient k of all loads, eliminated from both ends; what both leave for the meeting's tension.
CORDA_INLINE double eliminate(SeriesArrays& a, std::size_t k) {
    const std::size_t half = a.meeting / kLanes;
    double down = 0.0;
    double up = 0.0;
    a.load_before[0] = a.start_pull_m_s2.x * a.first_c[k] + a.start_pull_m_s2.y * a.first_s[k];
    for (std::size_t d = 0; d < a.blocks - half; ++d) {
        const std::size_t high = a.blocks - 1 - d;
        known_terms(a, high, k);
        if (d == 0) {
            a.load[a.links - 1] -= a.end_pull_m_s2.x * a.last_c[k] + a.end_pull_m_s2.y * a.last_s[k];
        } else {
            eliminate_down(a, high + 1, down);
        }
        if (d < half) {
            known_terms(a, d, k);
            eliminate_up(a, d, up);
        }
    }
    eliminate_down(a, half, down);
    return a.load[a.meeting] + a.weight[a.meeting] * down +
           (half > 0 ? (a.weight + a.meeting)[-1] * up : 0.0);
}

/// The tensions' coefficient from the meeting outwards, and the joints' turning, which needs none of it,
/// while they wait.
CORDA_INLINE void substitute(SeriesArrays& a, std::size_t k, double share, double at_meeting) {
    const std::size_t half = a.meeting / kLanes;
    double up = a.inverse_pivot[a.meeting] * at_meeting;
    double down = up;
    a.tension[a.meeting] = up;
    for (std::size_t d = 0; d < a.blocks - half; ++d) {
        const std::size_t high = half + d;
        for (std::size_t i = kLanes * high + (d == 0 ? 1 : 0); i < kLanes * (high + 1); ++i) {
            up = a.inverse_pivot[i] * a.load[i] + (a.weight + i)[-1] * up;
            a.tension[i] = up;
        }
        turn_joints(a, high, k, share);
        if (d >= half) continue;
        const std::size_t low = half - 1 - d;
        for (std::size_t i = kLanes * (low + 1); i-- > kLanes * low;) {
            down = a.inverse_pivot[i] * a.load[i] + a.weight[i] * down;
            a.tension[i] = down;
        }
        turn_joints(a, low, k, share);
    }
}

/// Coefficient k of the tensions and k + 1 of the rates, from the pulls across.
CORDA_INLINE void turn_links(SeriesArrays& a, std::size_t k, double share) {
    double* const next_rate = a.scratch;
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& tension = four(a.tension + i);
        const AnyFour& next_tension = any_four(a.tension + i + 1);
        const Four& sine = four(a.row(b, Row::kSine, 0));
        any_four(a.across_before + i + 1) += sine * tension;
        four(a.row(b, Row::kTension, k)) = tension;
        four(a.row(b, Row::kNextTension, k)) = next_tension;
        const Four across = four(a.across_after + i) + sine * next_tension - four(a.across_before + i);
        four(next_rate + i) =
            share * (across * four(a.inverse_length_1_m + i) - a.drag_1_s * four(a.row(b, Row::kRate, k)));
    }
    const std::size_t last = a.links - 1;
    next_rate[0] += share * a.inverse_length_1_m[0] *
                    (a.start_pull_m_s2.y * a.first_c[k] - a.start_pull_m_s2.x * a.first_s[k]);
    next_rate[last] -= share * a.inverse_length_1_m[last] *
                       (a.end_pull_m_s2.y * a.last_c[k] - a.end_pull_m_s2.x * a.last_s[k]);
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        four(a.row(b, Row::kRate, k + 1)) = four(next_rate + i);
        four(a.row(b, Row::kTurn, k + 1)) = any_four(next_rate + i + 1) - four(next_rate + i);
    }
}

/// Coefficient k + 1 of the direction of a link.
CORDA_INLINE void turn_direction(SeriesArrays& a, std::size_t link, std::size_t k, double share, Series& c,
                                 Series& s) {
    const double* rate = a.row(link / kLanes, Row::kRate, 0) + link % kLanes;
    double to_c = 0.0;
    double to_s = 0.0;
    for (std::size_t j = 0; j <= k; ++j) {
        to_c += rate[kLanes * j] * s[k - j];
        to_s += rate[kLanes * j] * c[k - j];
    }
    c[k + 1] = -share * to_c;
    s[k + 1] = share * to_s;
}

/// Coefficient k + 1 of the first particle's velocity and place.
CORDA_INLINE void move_start(SeriesArrays& a, std::size_t k, double share) {
    const double* const tension = a.row(0, Row::kTension, 0);
    Vec2 pull;
    for (std::size_t j = 0; j <= k; ++j) {
        pull.x += tension[kLanes * j] * a.first_c[k - j];
        pull.y += tension[kLanes * j] * a.first_s[k - j];
    }
    const Vec2 fall = k == 0 ? a.fall_m_s2 : Vec2{};
    a.vx[k + 1] = share * (fall.x + a.first_inverse_mass_1_kg * pull.x - a.drag_1_s * a.vx[k]);
    a.vy[k + 1] = share * (fall.y + a.first_inverse_mass_1_kg * pull.y - a.drag_1_s * a.vy[k]);
    a.x[k + 1] = share * a.vx[k];
    a.y[k + 1] = share * a.vy[k];
}

CORDA_INLINE void expand_series(SeriesArrays& a) {
    start_series(a);
    factorise(a);
    const std::size_t last = a.links - 1;
    a.first_c[0] = a.c[0];
    a.first_s[0] = a.s[0];
    a.last_c[0] = a.c[last];
    a.last_s[0] = a.s[last];
    for (std::size_t k = 0; k < a.order; ++k) {
        const double share = a.unit_s / static_cast<double>(k + 1);
        substitute(a, k, share, eliminate(a, k));
        turn_links(a, k, share);
        turn_direction(a, 0, k, share, a.first_c, a.first_s);
        turn_direction(a, last, k, share, a.last_c, a.last_s);
        if (a.first_inverse_mass_1_kg > 0.0) move_start(a, k, share);
    }
}

/// Cosine and sine of angles that are not too large (1e5), good to the last digit, from -, + and * alone.
/// Source: the polynomials of fdlibm (Sun Microsystems 1993), k_cos.c and k_sin.c, after a whole number of
/// right angles is taken off in two parts.
CORDA_INLINE void cosine_sine(const Four& angle, Four& cosine, Four& sine) {
    constexpr double kRounds = 0x1.8p+52;  // a sum with it has no digits after the point
    const Four turns = angle * 6.36619772367581382433e-01 + kRounds;
    const FourBits quarter = reinterpret_cast<const FourBits&>(turns);
    const Four whole = turns - kRounds;
    const Four x = (angle - whole * 1.57079632673412561417e+00) - whole * 6.07710050650619224932e-11;
    const Four z = x * x;
    const Four s =
        x + x * z *
                (-1.66666666666666324348e-01 +
                 z * (8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 +
                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const Four c = 1.0 - 0.5 * z +
                   z * z *
                       (4.16666666666666019037e-02 +
                        z * (-1.38888888888741095749e-03 +
                             z * (2.48015872894767294178e-05 +
                                  z * (-2.75573143513906633035e-07 +
                                       z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const FourBits& c_bits = reinterpret_cast<const FourBits&>(c);
    const FourBits& s_bits = reinterpret_cast<const FourBits&>(s);
    const FourBits odd = -(quarter & 1);  // all bits, or none
    const FourBits cosine_bits = ((~odd & c_bits) | (odd & s_bits)) ^ (((quarter + 1) & 2) << 62);
    const FourBits sine_bits = ((~odd & s_bits) | (odd & c_bits)) ^ ((quarter & 2) << 62);
    cosine = reinterpret_cast<const Four&>(cosine_bits);
    sine = reinterpret_cast<const Four&>(sine_bits);
}

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

/// Largest of coefficient k of the rates, in parts of `rate_1_s` and the rate itself.
CORDA_INLINE double largest_term(SeriesArrays& a, std::size_t k, double rate_1_s) {
    Four largest{};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const Four& term = four(a.row(b, Row::kRate, k));
        const Four& rate = four(a.row(b, Row::kRate, 0));
        const Four part = (term > -term ? term : -term) / (rate_1_s + (rate > -rate ? rate : -rate));
        largest = part <= largest ? largest : part;  // keeps what is not a number
    }
    double result = 0.0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if (!(largest[lane] <= result)) result = largest[lane];
    }
    return result;
}

CORDA_WIDE void expand_wide(SeriesArrays& a) {
    expand_series(a);
}
void expand_narrow(SeriesArrays& a) {
    expand_series(a);
}
CORDA_WIDE void evaluate_wide(SeriesArrays& a, double t) {
    evaluate_series(a, t);
}
void evaluate_narrow(SeriesArrays& a, double t) {
    evaluate_series(a, t);
}
CORDA_WIDE double largest_term_wide(SeriesArrays& a, std::size_t k, double rate_1_s) {
    return largest_term(a, k, rate_1_s);
}
double largest_term_narrow(SeriesArrays& a, std::size_t k, double rate_1_s) {
    return largest_term(a, k, rate_1_s);
}

/// Logarithm to the base 2 of x > 0 and its inverse, to 0.09 and 6 %: bits as they are, so that they are the
/// same everywhere.
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
    double shortest = std::numeric_limits<double>::infinity();  // logarithm
    for (std::size_t k = a.order + 1 - kLastTerms; k <= a.order; ++k) {
        double term = is_wide ? largest_term_wide(a, k, rate_1_s_) : largest_term_narrow(a, k, rate_1_s_);
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
