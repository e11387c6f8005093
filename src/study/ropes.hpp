#pragma once

#include "corda/sim/system.hpp"
#include "corda/study/references.hpp"

namespace corda::study {

/// A rope of unit masses through `points_m`, at rest, the first one pinned.
[[nodiscard]] sim::RopeDef rope_through(std::vector<sim::Vec2> points_m);

/// `links` + 1 particles in a straight line of `length_m` from the origin, at `angle_deg` from straight down
/// towards +x. Exactly horizontal at 90 degrees and exactly upright at 180.
[[nodiscard]] sim::RopeDef straight_rope(int links, double length_m, double angle_deg);

/// The rope of a row of R5.
[[nodiscard]] sim::RopeDef released_rope(const ReleasedChain& row);

/// The source report's start: a line of `particles` with step (0.1, -1) (PHYSICS sections 1 and 4, R11).
[[nodiscard]] sim::RopeDef report_rope(int particles);

/// A chain that hangs down from the origin by half of its links, goes one link across and up again, its end
/// free: R7. `links` is odd, the length 1 m.
[[nodiscard]] sim::RopeDef folded_rope(int links);

/// `links` links of 1.5 m in all, hung as a V between two pins 1 m apart: R6.
[[nodiscard]] sim::RopeDef slack_rope(int links);

/// A rope of `length_m` along +x that turns about its pin at `rate_1_s`: R8.
[[nodiscard]] sim::RopeDef spinning_rope(int links, double length_m, double rate_1_s);

/// The sum of the lengths of a rope's links, in metres.
[[nodiscard]] double length_m(const sim::RopeDef& rope);

}  // namespace corda::study
