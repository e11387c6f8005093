#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::film {

/// Maximum number of bodies whose curves one figure shows.
inline constexpr std::size_t kMaxBodies = 6;

/// A particle that represents the motion of its body: the free end of an open rope (the last one if both are
/// free), the middle one of the free particles of another rope, or the free particle of a net that is closest
/// to the mean of their positions at the start.
struct TrackedParticle {
    std::size_t body = 0;
    std::size_t particle = 0;  ///< of the system
    bool is_free_end = true;
    std::optional<std::size_t> pin = {};  ///< the only pinned particle of the body, of the system
};

/// The tracked particles of the first `most` bodies that have free particles.
[[nodiscard]] std::vector<TrackedParticle> tracked_particles(const System& system,
                                                             std::size_t most = kMaxBodies);

/// Within this share of its body's length from its pin, a tracked particle has no angle worth showing.
inline constexpr double kNearPin = 0.1;

/// Angle of the way from the pin of a tracked particle, which must have one, in rad from straight down,
/// positive towards +x, and its rate in rad/s, as x and y. Turns are counted on from the point of an earlier
/// state, if there is one, by the rate: between two states, a fast rope may turn by more than half a turn.
[[nodiscard]] view::CurvePoint turning_of(const TrackedParticle& tracked, const State& state,
                                          const view::CurvePoint* last);

/// The first free end of a rope; without one, the first tracked particle.
[[nodiscard]] std::size_t tip_of(const System& system);

}  // namespace corda::film
