#pragma once

#include <cstddef>

#include "corda/sim/exact/chain_dynamics.hpp"

namespace corda::sim {

/// Throws corda::Refusal if a chain of this length between two pins, the particles `from` and `to` at a
/// distance of `span_m`, is taut.
void refuse_taut_between_pins(double length_m, Vec2 span_m, std::size_t from, std::size_t to);

/// Where a particle is and how it moves, seen from another.
struct Span {
    Vec2 place_m, velocity_m_s;
};

/// The end of a chain between two pins, seen from its start.
[[nodiscard]] Span span_at(const Chains& chains, const Chain& chain, double time_s);

/// Brings the end of a chain between two pins back to where its pin is at `time_s`, and the end's velocity to
/// that of the pin, by the least changes of the links' directions and angular velocities. A direction is NaN,
/// and the run diverges, if the pins are farther apart than the chain is long.
void close_between_pins(const Chains& chains, const Chain& chain, double time_s, double* y);

/// 0 if all links of a chain are in one line, where they do not determine the tensions between two pins;
/// grows with the square of the angles from it, up to 1/4.
[[nodiscard]] double spread(const Chains& chains, const Chain& chain, const double* y);

}  // namespace corda::sim
