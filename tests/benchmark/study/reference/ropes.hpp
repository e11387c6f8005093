#pragma once

#include "benchmark/study/reference/numbers.hpp"
#include "corda/sim/system.hpp"

namespace corda::reference {

/// A rope of unit masses at `points_m`, at rest; the first particle is pinned.
[[nodiscard]] RopeDef rope_through(std::vector<Vec2> points_m);

/// `links` + 1 particles on a straight line of `length_m` from the origin, at `angle_deg` from straight down
/// towards +x. At 90 and 180 degrees it is horizontal and upright without rounding.
[[nodiscard]] RopeDef straight_rope(int links, double length_m, double angle_deg);

/// The rope that a row of R5 is about.
[[nodiscard]] RopeDef released_rope(const ReleasedChain& row);

/// The source report's start: a line of `particles` with step (0.1, -1) (section 1 of
/// src/corda/sim/README.md, R11).
[[nodiscard]] RopeDef report_rope(int particles);

/// The folded chain of R7: half of its links hang down from the origin, one goes across, the others go up to
/// the free end. `links` is odd; the length is 1 m.
[[nodiscard]] RopeDef folded_rope(int links);

/// The chain of R6 before it settles: `links` links of 1.5 m in all, hung as a V between two pins 1 m apart.
[[nodiscard]] RopeDef slack_rope(int links);

/// The spinning chain of R8: `length_m` along +x, turning about its pin with the angular velocity
/// `omega_1_s`.
[[nodiscard]] RopeDef spinning_rope(int links, double length_m, double omega_1_s);

/// The sum of the initial lengths of a rope's links, in metres.
[[nodiscard]] double length_m(const RopeDef& rope);

}  // namespace corda::reference
