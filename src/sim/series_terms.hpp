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

/// As in ChainDynamics: far below all that can be seen, and set to zero before it gets denormal.
inline constexpr double kNegligible = 1e-60;

/// Reads a number a link: of `links` links, zero beyond.
CORDA_INLINE void read_links(const SeriesArrays& a, const double* from, double* to) {
    for (std::size_t i = 0; i < a.links; i += kLanes) {
        Four x{};
        if (i + kLanes <= a.links) {
            x = any_four(from + i).value;
        } else {
            for (std::size_t lane = 0; i + lane < a.links; ++lane) x[lane] = from[i + lane];
        }
        const Four size = x > -x ? x : -x;
        four(to + i) = size < kNegligible ? Four{} : x;
    }
}

/// Directions, rates and turns at t = 0.
CORDA_INLINE void start_series(SeriesArrays& a) {
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& c = four(a.c + i);
        const Four& s = four(a.s + i);
        const Four& rate = four(a.rate + i);
        Four next_c;
        Four next_s;
        Four next_rate;
        shift_down(c, four(a.c + i + kLanes), next_c);
        shift_down(s, four(a.s + i + kLanes), next_s);
        shift_down(rate, four(a.rate + i + kLanes), next_rate);
        const Four& inverse_mass = four(a.inverse_mass_1_kg + i);
        const Four sine = inverse_mass * (c * next_s - s * next_c);
        four(a.row(b, Row::kCosine, 0)) = inverse_mass * (c * next_c + s * next_s);
        four(a.row(b, Row::kSine, 0)) = sine;
        four(a.scratch + i) = sine * sine;
        four(a.row(b, Row::kRate, 0)) = rate;
        four(a.row(b, Row::kTurn, 0)) = next_rate - rate;
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
        Four pivot = four(a.inverse_pivot + i);
        if (i >= a.meeting) shift_down(pivot, four(a.inverse_pivot + i + kLanes), pivot);
        four(a.weight + i) = four(a.row(b, Row::kCosine, 0)) * pivot;
    }
}

/// What is known of coefficient k of a block without the tensions' coefficient k.
struct Known {
    Four load{};       ///< right-hand sides of the tensions, less what the joint before each link adds
    Four load_next{};  ///< what its own joint adds to that of the next link
    /// Adds what the joints before add; `lower` is of the block below.
    CORDA_INLINE void complete(const Four& lower_load_next) {
        Four before;
        shift_up(lower_load_next, load_next, before);
        load += before;
    }
};

/// Writes the pulls across links that are known to across_next and across_after.
CORDA_INLINE void find_known(SeriesArrays& a, std::size_t b, std::size_t k, Known& known) {
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
    known.load_next = load_next;
    known.load = four(a.length_m + i) * square + load;
    four(a.across_next + i) = across_next;
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

/// A block's elimination towards lower links, to its link `to`, from its loads; `last` is the load of the
/// link above.
CORDA_INLINE void eliminate_down(SeriesArrays& a, std::size_t b, std::size_t to, const Four& load,
                                 double& last) {
    const std::size_t first = kLanes * b;
    for (std::size_t lane = kLanes; lane-- > to;) {
        last = load[lane] + a.weight[first + lane] * last;
        a.load[first + lane] = last;
    }
}

/// The same towards higher links, from a block below the meeting.
CORDA_INLINE void eliminate_up(SeriesArrays& a, std::size_t b, const Four& load, double& last) {
    const double* const weight = a.weight + kLanes * b;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        last = load[lane] + (weight + lane)[-1] * last;
        a.load[kLanes * b + lane] = last;
    }
}

/// A number in the lane of a chain's last link, for lanes of its block that are all zero.
CORDA_INLINE void in_last_lane(const SeriesArrays& a, double x, Four& result) {
    constexpr Four kLane{0.0, 1.0, 2.0, 3.0};
    const Four is_last = Four{} + static_cast<double>((a.links - 1) % kLanes);
    result = kLane == is_last ? Four{} + x : Four{};
}

/// Coefficient k of all loads, eliminated from both ends; what both leave for the meeting's tension.
CORDA_INLINE double eliminate(SeriesArrays& a, std::size_t k) {
    const std::size_t half = a.meeting / kLanes;
    double down = 0.0;
    double up = 0.0;
    Four lower_next{};  // load_next of the block that eliminate_up has come to, or the pull of a pin
    lower_next[kLanes - 1] = a.start_pull_m_s2.x * a.first_c[k] + a.start_pull_m_s2.y * a.first_s[k];
    Known upper;
    for (std::size_t d = 0; d < a.blocks - half; ++d) {
        const std::size_t high = a.blocks - 1 - d;
        Known known;
        find_known(a, high, k, known);
        if (d == 0) {
            Four end_pull;
            in_last_lane(a, a.end_pull_m_s2.x * a.last_c[k] + a.end_pull_m_s2.y * a.last_s[k], end_pull);
            known.load -= end_pull;
        } else {
            upper.complete(known.load_next);
            eliminate_down(a, high + 1, 0, upper.load, down);
        }
        upper = known;
        if (d < half) {
            find_known(a, d, k, known);
            known.complete(lower_next);
            lower_next = known.load_next;
            eliminate_up(a, d, known.load, up);
        }
    }
    upper.complete(lower_next);
    eliminate_down(a, half, 1, upper.load, down);
    return upper.load[0] + a.weight[a.meeting] * down + (half > 0 ? (a.weight + a.meeting)[-1] * up : 0.0);
}

/// Coefficient k of the tensions of a block, upwards; `last` is that of the link below.
CORDA_INLINE void substitute_up(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    Four tension;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t i = first + lane;
        last = a.inverse_pivot[i] * a.load[i] + (a.weight + i)[-1] * last;
        tension[lane] = last;
    }
    four(a.tension + first) = tension;
}

/// Of the meeting's block, whose first link's tension is `last`.
CORDA_INLINE void substitute_from_meeting(SeriesArrays& a, double& last) {
    Four tension;
    tension[0] = last;
    for (std::size_t lane = 1; lane < kLanes; ++lane) {
        const std::size_t i = a.meeting + lane;
        last = a.inverse_pivot[i] * a.load[i] + (a.weight + i)[-1] * last;
        tension[lane] = last;
    }
    four(a.tension + a.meeting) = tension;
}

/// The same downwards, of a block below the meeting, from its last link.
CORDA_INLINE void substitute_down(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    Four tension;
    for (std::size_t lane = kLanes; lane-- > 0;) {
        const std::size_t i = first + lane;
        last = a.inverse_pivot[i] * a.load[i] + a.weight[i] * last;
        tension[lane] = last;
    }
    four(a.tension + first) = tension;
}

/// The tensions' coefficient from the meeting outwards, and the joints' turning, which needs none of it,
/// while they wait. The highest order has no use for the next of the joints.
CORDA_INLINE void substitute(SeriesArrays& a, std::size_t k, double share, double at_meeting) {
    const std::size_t half = a.meeting / kLanes;
    const bool goes_on = k + 1 < a.order;
    double up = a.inverse_pivot[a.meeting] * at_meeting;
    double down = up;
    substitute_from_meeting(a, up);
    if (goes_on) turn_joints(a, half, k, share);
    for (std::size_t d = 1; d <= half; ++d) {
        if (half + d < a.blocks) {
            substitute_up(a, half + d, up);
            if (goes_on) turn_joints(a, half + d, k, share);
        }
        substitute_down(a, half - d, down);
        if (goes_on) turn_joints(a, half - d, k, share);
    }
}

/// Coefficient k of the tensions and k + 1 of the rates, from the pulls across.
CORDA_INLINE void turn_links(SeriesArrays& a, std::size_t k, double share) {
    const std::size_t last = a.links - 1;
    Four first_pull{};
    first_pull[0] = share * a.inverse_length_1_m[0] *
                    (a.start_pull_m_s2.y * a.first_c[k] - a.start_pull_m_s2.x * a.first_s[k]);
    Four last_pull;
    in_last_lane(a,
                 share * a.inverse_length_1_m[last] *
                     (a.end_pull_m_s2.y * a.last_c[k] - a.end_pull_m_s2.x * a.last_s[k]),
                 last_pull);
    Four across_before{};  // of the block before
    Four rate_before{};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& tension = four(a.tension + i);
        const Four& sine = four(a.row(b, Row::kSine, 0));
        Four next_tension;
        shift_down(tension, four(a.tension + i + kLanes), next_tension);
        four(a.row(b, Row::kTension, k)) = tension;
        four(a.row(b, Row::kNextTension, k)) = next_tension;
        const Four across_next = four(a.across_next + i) + sine * tension;
        Four before;
        shift_up(across_before, across_next, before);
        across_before = across_next;
        const Four across = four(a.across_after + i) + sine * next_tension - before;
        Four rate =
            share * (across * four(a.inverse_length_1_m + i) - a.drag_1_s * four(a.row(b, Row::kRate, k)));
        if (b == 0) rate += first_pull;
        if (b + 1 == a.blocks) rate -= last_pull;
        four(a.row(b, Row::kRate, k + 1)) = rate;
        if (b > 0) {
            shift_down(rate_before, rate, before);
            four(a.row(b - 1, Row::kTurn, k + 1)) = before - rate_before;
        }
        rate_before = rate;
    }
    Four after;
    shift_down(rate_before, Four{}, after);
    four(a.row(a.blocks - 1, Row::kTurn, k + 1)) = after - rate_before;
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

/// All coefficients, from the directions c, s and the rates of the links at t = 0.
CORDA_INLINE void expand(SeriesArrays& a, const double* c, const double* s, const double* rate) {
    read_links(a, c, a.c);
    read_links(a, s, a.s);
    read_links(a, rate, a.rate);
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
        if (k + 1 < a.order) {
            turn_direction(a, 0, k, share, a.first_c, a.first_s);
            turn_direction(a, last, k, share, a.last_c, a.last_s);
        }
        if (a.first_inverse_mass_1_kg > 0.0) move_start(a, k, share);
    }
}

}  // namespace corda::sim::series
