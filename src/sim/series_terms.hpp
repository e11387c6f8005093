#pragma once

#include <cstddef>

#include "corda/sim/chain_series.hpp"
#include "corda/sim/four.hpp"

// The coefficients of a ChainSeries, one after the other: see there.
namespace corda::sim::series {

inline constexpr std::size_t kLanes = kSeriesLanes;
static_assert(kLanes == kFour);

/// Fractions are rescaled, by a power of two and so without rounding, before they grow out of range.
inline constexpr double kLargeFraction = 0x1p+300;
inline constexpr double kSmallFraction = 0x1p-300;

using Row = SeriesArrays::Row;

/// Directions, rates and turns at t = 0.
CORDA_INLINE void start_series(SeriesArrays& a) {
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& c = four(a.c + i);
        const Four& s = four(a.s + i);
        const Four next_c = any_four(a.c + i + 1).value;
        const Four next_s = any_four(a.s + i + 1).value;
        const Four& inverse_mass = four(a.inverse_mass_1_kg + i);
        const Four sine = inverse_mass * (c * next_s - s * next_c);
        four(a.row(b, Row::kCosine, 0)) = inverse_mass * (c * next_c + s * next_s);
        four(a.row(b, Row::kSine, 0)) = sine;
        four(a.scratch + i) = sine * sine;
        four(a.row(b, Row::kRate, 0)) = four(a.rate + i);
        four(a.row(b, Row::kTurn, 0)) = any_four(a.rate + i + 1).value - four(a.rate + i);
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
            four(a.row(b, Row::kCosine, 0)) * any_four(a.inverse_pivot + i + (is_low ? 0 : 1)).value;
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
    any_four(a.load_before + i + 1).value = load_next;
    four(a.load + i) = four(a.length_m + i) * square + load;
    any_four(a.across_before + i + 1).value = across_next;
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

/// A block's elimination towards lower links, to its link `to`; `last` is the load of the link above.
CORDA_INLINE void eliminate_down(SeriesArrays& a, std::size_t b, std::size_t to, double& last) {
    const std::size_t first = kLanes * b;
    four(a.load + first) += four(a.load_before + first);
    for (std::size_t lane = kLanes; lane-- > to;) {
        last = a.load[first + lane] + a.weight[first + lane] * last;
        a.load[first + lane] = last;
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
            eliminate_down(a, high + 1, 0, down);
        }
        if (d < half) {
            known_terms(a, d, k);
            eliminate_up(a, d, up);
        }
    }
    eliminate_down(a, half, 1, down);
    return a.load[a.meeting] + a.weight[a.meeting] * down +
           (half > 0 ? (a.weight + a.meeting)[-1] * up : 0.0);
}

/// Coefficient k of the tensions of a block from its link `from` on; `last` is that of the link below.
CORDA_INLINE void substitute_up(SeriesArrays& a, std::size_t b, std::size_t from, double& last) {
    const std::size_t first = kLanes * b;
    for (std::size_t i = first + from; i < first + kLanes; ++i) {
        last = a.inverse_pivot[i] * a.load[i] + (a.weight + i)[-1] * last;
        a.tension[i] = last;
    }
}

/// The same of a block below the meeting, from its last link.
CORDA_INLINE void substitute_down(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    for (std::size_t i = first + kLanes; i-- > first;) {
        last = a.inverse_pivot[i] * a.load[i] + a.weight[i] * last;
        a.tension[i] = last;
    }
}

/// The tensions' coefficient from the meeting outwards, and the joints' turning, which needs none of it,
/// while they wait.
CORDA_INLINE void substitute(SeriesArrays& a, std::size_t k, double share, double at_meeting) {
    const std::size_t half = a.meeting / kLanes;
    double up = a.inverse_pivot[a.meeting] * at_meeting;
    double down = up;
    a.tension[a.meeting] = up;
    substitute_up(a, half, 1, up);
    turn_joints(a, half, k, share);
    for (std::size_t d = 1; d <= half; ++d) {
        if (half + d < a.blocks) {
            substitute_up(a, half + d, 0, up);
            turn_joints(a, half + d, k, share);
        }
        substitute_down(a, half - d, down);
        turn_joints(a, half - d, k, share);
    }
}

/// Coefficient k of the tensions and k + 1 of the rates, from the pulls across.
CORDA_INLINE void turn_links(SeriesArrays& a, std::size_t k, double share) {
    double* const next_rate = a.scratch;
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& tension = four(a.tension + i);
        const Four next_tension = any_four(a.tension + i + 1).value;
        const Four& sine = four(a.row(b, Row::kSine, 0));
        any_four(a.across_before + i + 1).value += sine * tension;
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
        four(a.row(b, Row::kTurn, k + 1)) = any_four(next_rate + i + 1).value - four(next_rate + i);
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

/// All coefficients, from the directions and rates at t = 0.
CORDA_INLINE void expand(SeriesArrays& a) {
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

}  // namespace corda::sim::series
