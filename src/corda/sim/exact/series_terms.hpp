#pragma once

#include <algorithm>
#include <cstddef>

#include "corda/sim/chain_tensions.hpp"
#include "corda/sim/cosine_sine.hpp"
#include "corda/sim/exact/chain_series.hpp"
#include "corda/sim/four.hpp"

namespace corda::sim {

using FourBits [[gnu::vector_size(kSeriesLanes * sizeof(double))]] = long long;
static_assert(kSeriesLanes == kFour);

/// The last of `before` and the first three of `here`. From registers, because a load that spans two stores
/// just made would wait until both are in the cache.
CORDA_INLINE void shift_up(const Four& before, const Four& here, Four& result) {
    result = __builtin_shufflevector(before, here, 3, 4, 5, 6);
}
/// The last three of `here` and the first of `after`.
CORDA_INLINE void shift_down(const Four& here, const Four& after, Four& result) {
    result = __builtin_shufflevector(here, after, 1, 2, 3, 4);
}

/// Cosine and sine of angles up to about 1e5, good to the last digit, from +, - and * alone. Source: the
/// polynomials of fdlibm (Sun Microsystems 1993), k_cos.c and k_sin.c, after a whole number of right angles
/// is subtracted in two parts.
CORDA_INLINE CosineSine<Four> cosine_sine(const Four& angle) {
    constexpr double kRounds = 0x1.8p+52;  // a sum with it has no digits after the point
    const Four turns = angle * 6.36619772367581382433e-01 + kRounds;
    const FourBits quarter = reinterpret_cast<FourBits>(turns);
    const Four whole = turns - kRounds;
    const Four x = (angle - whole * 1.57079632673412561417e+00) - whole * 6.07710050650619224932e-11;
    const auto [c, s] = cosine_sine_of_small(x);
    const FourBits c_bits = reinterpret_cast<FourBits>(c);
    const FourBits s_bits = reinterpret_cast<FourBits>(s);
    const FourBits odd = -(quarter & 1);  // all bits, or none
    const FourBits cosine_bits = ((~odd & c_bits) | (odd & s_bits)) ^ (((quarter + 1) & 2) << 62);
    const FourBits sine_bits = ((~odd & s_bits) | (odd & c_bits)) ^ ((quarter & 2) << 62);
    return {reinterpret_cast<Four>(cosine_bits), reinterpret_cast<Four>(sine_bits)};
}

}  // namespace corda::sim

// The coefficients of a ChainSeries, one after the other: see section 5 of src/corda/sim/exact/README.md.
namespace corda::sim::series {

inline constexpr std::size_t kLanes = kSeriesLanes;

using Row = SeriesArrays::Row;

/// Reads one number per link and pads with zeros.
CORDA_INLINE void read_links(const SeriesArrays& a, const double* from, double* to) {
    for (std::size_t i = 0; i < a.links; i += kLanes) {
        Four x{};
        if (i + kLanes <= a.links) {
            x = any_four(from + i).value;
        } else {
            for (std::size_t lane = 0; i + lane < a.links; ++lane) x[lane] = from[i + lane];
        }
        four(to + i) = x;
    }
}

/// Coefficients 0 of the joints and of the angular velocities.
CORDA_INLINE void start_series(SeriesArrays& a) {
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kLanes * b;
        const Four& c = four(a.c + i);
        const Four& s = four(a.s + i);
        const Four& omega = four(a.omega + i);
        Four next_c;
        Four next_s;
        Four next_omega;
        shift_down(c, four(a.c + i + kLanes), next_c);
        shift_down(s, four(a.s + i + kLanes), next_s);
        shift_down(omega, four(a.omega + i + kLanes), next_omega);
        const Four& inverse_mass = four(a.inverse_mass_1_kg + i);
        const Four sine = inverse_mass * (c * next_s - s * next_c);
        four(a.row(b, Row::kCosine, 0)) = inverse_mass * (c * next_c + s * next_s);
        four(a.row(b, Row::kSine, 0)) = sine;
        four(a.scratch + i) = sine * sine;
        four(a.row(b, Row::kOmega, 0)) = omega;
        four(a.row(b, Row::kOpening, 0)) = next_omega - omega;
    }
}

/// Factorises the matrix of the tensions into inverse pivots and weights.
CORDA_INLINE void factorise(SeriesArrays& a) {
    double* const q = a.load;
    double* const divisor = a.across_after;
    std::size_t high = a.links - 1;
    std::size_t low = 0;
    InverseMassFraction from_end{a.inverse_mass_1_kg[high]};
    InverseMassFraction from_start{a.first_inverse_mass_1_kg};
    // Writes a link's q and pivot times q, and passes its joint.
    const auto pass = [&](InverseMassFraction& fraction, std::size_t link, std::size_t joint) {
        q[link] = fraction.q;
        divisor[link] = fraction.divisor(a.inverse_mass_1_kg[joint]);
        fraction.pass(a.inverse_mass_1_kg[joint], a.scratch[joint], divisor[link]);
    };
    while (high > a.meeting || low < a.meeting) {
        if (high > a.meeting) {
            pass(from_end, high, high - 1);
            --high;
        }
        if (low < a.meeting) {
            pass(from_start, low, low);
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

/// Parts of coefficient k of a block that do not depend on coefficient k of the tensions.
struct Known {
    Four load{};       ///< right-hand sides of the tensions, without the terms of the joint before each link
    Four load_next{};  ///< terms of a link's own joint in the right-hand side of the next link
    /// Adds the terms of the joints before; `lower_load_next` is that of the block below.
    CORDA_INLINE void complete(const Four& lower_load_next) {
        Four before;
        shift_up(lower_load_next, load_next, before);
        load += before;
    }
};

/// Computes `known`, and writes the known parts of the pulls across links to across_next and across_after.
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
    const double* omega = a.row(b, Row::kOmega, 0);
    const double* last_omega = a.row(b, Row::kOmega, k);
    Four square{};
    for (; omega < last_omega; omega += kLanes, last_omega -= kLanes)
        square += four(omega) * four(last_omega);
    square += square;
    if (omega == last_omega) square += four(omega) * four(omega);
    const std::size_t i = kLanes * b;
    known.load_next = load_next;
    known.load = four(a.length_m + i) * square + load;
    four(a.across_next + i) = across_next;
    four(a.across_after + i) = across;
}

/// Coefficients k + 1 of W C and W S of the joints.
CORDA_INLINE void turn_joints(SeriesArrays& a, std::size_t b, std::size_t k, double share) {
    const double* turn = a.row(b, Row::kOpening, 0);
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

/// Eliminates a block's loads towards lower links, down to lane `to`; `last` is the eliminated load of the
/// link above.
CORDA_INLINE void eliminate_down(SeriesArrays& a, std::size_t b, std::size_t to, const Four& load,
                                 double& last) {
    const std::size_t first = kLanes * b;
    for (std::size_t lane = kLanes; lane-- > to;) {
        last = load[lane] + a.weight[first + lane] * last;
        a.load[first + lane] = last;
    }
}

/// The same towards higher links, for a block below the meeting.
CORDA_INLINE void eliminate_up(SeriesArrays& a, std::size_t b, const Four& load, double& last) {
    const double* const weight = a.weight + kLanes * b;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        last = load[lane] + (weight + lane)[-1] * last;
        a.load[kLanes * b + lane] = last;
    }
}

/// x in the lane of the chain's last link, 0 in the other lanes of its block.
CORDA_INLINE void in_last_lane(const SeriesArrays& a, double x, Four& result) {
    constexpr Four kLane{0.0, 1.0, 2.0, 3.0};
    const Four is_last = Four{} + static_cast<double>((a.links - 1) % kLanes);
    result = kLane == is_last ? Four{} + x : Four{};
}

/// Coefficient k of a pull along a link's direction.
CORDA_INLINE double pull_along(const SeriesArrays::Pull& pull, const SeriesArrays::Direction& direction,
                               std::size_t k) {
    const auto& [c, s] = direction;
    double sum = pull.first.x * c[k] + pull.first.y * s[k];
    for (std::size_t j = 1; j <= std::min(k, pull.changes); ++j)
        sum += pull.term[j].x * c[k - j] + pull.term[j].y * s[k - j];
    return sum;
}

/// The same to its left.
CORDA_INLINE double pull_across(const SeriesArrays::Pull& pull, const SeriesArrays::Direction& direction,
                                std::size_t k) {
    const auto& [c, s] = direction;
    double sum = pull.first.y * c[k] - pull.first.x * s[k];
    for (std::size_t j = 1; j <= std::min(k, pull.changes); ++j)
        sum += pull.term[j].y * c[k - j] - pull.term[j].x * s[k - j];
    return sum;
}

/// Eliminates coefficient k of all loads from both ends. Returns the load that is left for the meeting.
CORDA_INLINE double eliminate(SeriesArrays& a, std::size_t k) {
    const std::size_t half = a.meeting / kLanes;
    double down = 0.0;
    double up = 0.0;
    Four lower_next{};  // load_next of the block below that of eliminate_up, or a pin's pull
    lower_next[kLanes - 1] = pull_along(a.start_pull_m_s2, a.first_link, k);
    Known upper;
    for (std::size_t d = 0; d < a.blocks - half; ++d) {
        const std::size_t high = a.blocks - 1 - d;
        Known known;
        find_known(a, high, k, known);
        if (d == 0) {
            Four end_pull;
            in_last_lane(a, pull_along(a.end_pull_m_s2, a.last_link, k), end_pull);
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

/// The tensions of a block from lane kFrom, 0 or 1, upwards; `last` is the tension of the link below.
template <std::size_t kFrom>
CORDA_INLINE void substitute_up(SeriesArrays& a, std::size_t b, double& last) {
    const std::size_t first = kLanes * b;
    Four tension;
    if constexpr (kFrom == 1) tension[0] = last;
    for (std::size_t lane = kFrom; lane < kLanes; ++lane) {
        const std::size_t i = first + lane;
        last = a.inverse_pivot[i] * a.load[i] + (a.weight + i)[-1] * last;
        tension[lane] = last;
    }
    four(a.tension + first) = tension;
}

/// The same downwards, for a block below the meeting.
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

/// Coefficient k of the tensions, from the meeting outwards. The joints' coefficients k + 1 do not need it
/// and fill the waiting; the highest order does not use them.
CORDA_INLINE void substitute(SeriesArrays& a, std::size_t k, double share, double at_meeting) {
    const std::size_t half = a.meeting / kLanes;
    const bool goes_on = k + 1 < a.order;
    double up = a.inverse_pivot[a.meeting] * at_meeting;
    double down = up;
    substitute_up<1>(a, half, up);
    if (goes_on) turn_joints(a, half, k, share);
    for (std::size_t d = 1; d <= half; ++d) {
        if (half + d < a.blocks) {
            substitute_up<0>(a, half + d, up);
            if (goes_on) turn_joints(a, half + d, k, share);
        }
        substitute_down(a, half - d, down);
        if (goes_on) turn_joints(a, half - d, k, share);
    }
}

/// Stores coefficient k of the tensions and computes coefficient k + 1 of the angular velocities from the
/// pulls across.
CORDA_INLINE void turn_links(SeriesArrays& a, std::size_t k, double share) {
    const std::size_t last = a.links - 1;
    Four first_pull{};
    first_pull[0] = share * a.inverse_length_1_m[0] * pull_across(a.start_pull_m_s2, a.first_link, k);
    Four last_pull;
    in_last_lane(a, share * a.inverse_length_1_m[last] * pull_across(a.end_pull_m_s2, a.last_link, k),
                 last_pull);
    Four across_before{};  // across_next of the block before
    Four omega_before{};
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
        Four omega =
            share * (across * four(a.inverse_length_1_m + i) - a.drag_1_s * four(a.row(b, Row::kOmega, k)));
        if (b == 0) omega += first_pull;
        if (b + 1 == a.blocks) omega -= last_pull;
        four(a.row(b, Row::kOmega, k + 1)) = omega;
        if (b > 0) {
            shift_down(omega_before, omega, before);
            four(a.row(b - 1, Row::kOpening, k + 1)) = before - omega_before;
        }
        omega_before = omega;
    }
    Four after;
    shift_down(omega_before, Four{}, after);
    four(a.row(a.blocks - 1, Row::kOpening, k + 1)) = after - omega_before;
}

/// Coefficient k + 1 of a link's direction.
CORDA_INLINE void turn_direction(SeriesArrays& a, std::size_t link, std::size_t k, double share,
                                 SeriesArrays::Direction& direction) {
    auto& [c, s] = direction;
    const double* omega = a.row(link / kLanes, Row::kOmega, 0) + link % kLanes;
    double to_c = 0.0;
    double to_s = 0.0;
    for (std::size_t j = 0; j <= k; ++j) {
        to_c += omega[kLanes * j] * s[k - j];
        to_s += omega[kLanes * j] * c[k - j];
    }
    c[k + 1] = -share * to_c;
    s[k + 1] = share * to_s;
}

/// Coefficient k + 1 of the velocity and place of a free chain's centre of mass.
CORDA_INLINE void move_center(SeriesArrays& a, std::size_t k, double share) {
    const Vec2 fall = k == 0 ? a.fall_m_s2.first : k <= a.fall_m_s2.changes ? a.fall_m_s2.term[k] : Vec2{};
    a.vx[k + 1] = share * (fall.x - a.drag_1_s * a.vx[k]);
    a.vy[k + 1] = share * (fall.y - a.drag_1_s * a.vy[k]);
    a.x[k + 1] = share * a.vx[k];
    a.y[k + 1] = share * a.vy[k];
}

/// All coefficients, from the directions c, s and the angular velocities of the links at t = 0.
CORDA_INLINE void expand(SeriesArrays& a, const double* c, const double* s, const double* omega) {
    read_links(a, c, a.c);
    read_links(a, s, a.s);
    read_links(a, omega, a.omega);
    start_series(a);
    factorise(a);
    const std::size_t last = a.links - 1;
    a.first_link.c[0] = a.c[0];
    a.first_link.s[0] = a.s[0];
    a.last_link.c[0] = a.c[last];
    a.last_link.s[0] = a.s[last];
    for (std::size_t k = 0; k < a.order; ++k) {
        const double share = a.unit_s / static_cast<double>(k + 1);
        substitute(a, k, share, eliminate(a, k));
        turn_links(a, k, share);
        if (k + 1 < a.order) {
            turn_direction(a, 0, k, share, a.first_link);
            turn_direction(a, last, k, share, a.last_link);
        }
        if (a.first_inverse_mass_1_kg > 0.0) move_center(a, k, share);
    }
}

}  // namespace corda::sim::series
