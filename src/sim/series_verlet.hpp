#pragma once

#include <cstddef>

#include "corda/sim/chain_series.hpp"
#include "corda/sim/four.hpp"

// What makes steps of the velocity Verlet method of a ChainSeries of order 1: see there.
namespace corda::sim::series {

/// The largest of four numbers; one that is none stays.
CORDA_INLINE double largest_of(const Four& numbers) {
    double result = 0.0;
    for (std::size_t lane = 0; lane < kFour; ++lane) {
        if (!(numbers[lane] <= result)) result = numbers[lane];
    }
    return result;
}

/// Gives the rates at the start of the series half of what their slopes have changed by over the last step,
/// of `last_s`, and keeps the slopes. Returns the largest change of a rate, 1/s.
CORDA_INLINE double correct_rates(SeriesArrays& a, double last_s) {
    const double share_s = 0.5 * last_s;
    const double inverse_unit_1_s = 1.0 / a.unit_s;
    Four largest{};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        Four& last_slope = four(a.last_slope + kFour * b);
        const Four slope = inverse_unit_1_s * four(a.row(b, SeriesArrays::kRate, 1));
        const Four change = share_s * (slope - last_slope);
        four(a.row(b, SeriesArrays::kRate, 0)) += change;
        last_slope = slope;
        const Four size = change > -change ? change : -change;
        largest = size <= largest ? largest : size;  // keeps what is not a number
    }
    return largest_of(largest);
}

/// Gershgorin's bound on the square of the largest frequency of small oscillations across the links, whose
/// stiffness is tension over length: the largest 2 W_i (|T_i| / a_i + |T_{i+1}| / a_{i+1}).
CORDA_INLINE double square_frequency(SeriesArrays& a) {
    Four largest{};
    for (std::size_t b = 0; b < a.blocks; ++b) {
        const std::size_t i = kFour * b;
        const Four& inverse_length = four(a.inverse_length_1_m + i);
        Four next_inverse_length;
        shift_down(inverse_length, four(a.inverse_length_1_m + i + kFour), next_inverse_length);
        const Four here = inverse_length * four(a.row(b, SeriesArrays::kTension, 0));
        const Four next = next_inverse_length * four(a.row(b, SeriesArrays::kNextTension, 0));
        const Four sum = (here > -here ? here : -here) + (next > -next ? next : -next);
        const Four square = 2.0 * four(a.inverse_mass_1_kg + i) * sum;
        largest = square <= largest ? largest : square;
    }
    return largest_of(largest);
}

}  // namespace corda::sim::series
