#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The time of an event that there is none of.
inline constexpr double kNoEvent = std::numeric_limits<double>::infinity();

/// Each lets go of another pinned particle, at a time from 0 s on.
[[nodiscard]] bool are_valid(std::span<const ReleaseDef> releases, std::span<const std::uint32_t> pinned);
/// Each cuts another link, below `links`, at a time from 0 s on.
[[nodiscard]] bool are_valid(std::span<const CutDef> cuts, std::size_t links);

/// Writes when the bars of the last body go to System::cut_s. An imaginary bar of a rope goes with the first
/// of the links that it spans, one of a net with the first link of two that lead from its one end to the
/// other.
void add_cuts(std::span<const CutDef> cuts, const Body& body, System& system);

/// The times at which pins are let go or bars cut, in order, each once.
[[nodiscard]] std::vector<double> event_times_s(const System& system);

/// "pins let go at 1 s, links cut at 2, 3 s"; empty without any.
[[nodiscard]] std::string events_text(std::span<const RopeDef> ropes, std::span<const NetDef> nets);

/// The system with the pins that are left from a time on, and their moves. Its positions and velocities are
/// those of the start, and bars that are gone stay in its arrays.
[[nodiscard]] System from_event_on(System system, double time_s);

}  // namespace corda::sim
