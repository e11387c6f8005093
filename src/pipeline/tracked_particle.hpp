#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::pipeline {

/// Most bodies whose curves one figure shows.
inline constexpr std::size_t kMaxBodies = 6;

/// A particle whose motion stands for that of its body: the free end of an open rope (of two the last), the
/// middle one of the free particles of another rope, and of a net the free one that is nearest to the mean of
/// their positions at the start.
struct TrackedParticle {
    std::size_t body = 0;
    std::size_t particle = 0;  ///< of the system
    bool is_free_end = true;
    std::optional<std::size_t> pin = {};  ///< the only pinned particle of the body, of the system
};

/// Those of the bodies with free particles, at most kMaxBodies: the first ones.
[[nodiscard]] std::vector<TrackedParticle> tracked_particles(const System& system);

/// How many bodies have free particles.
[[nodiscard]] std::size_t moving_count(const System& system);

/// "the free end of rope 0 (particle 20)", "particle 599 of net 0 (the most central of its free ones)".
[[nodiscard]] std::string describe(const System& system, const TrackedParticle& followed);

/// The same of several: "the free ends of rope 0 to rope 5 (particle 2 of each)".
[[nodiscard]] std::string describe(const System& system, const std::vector<TrackedParticle>& followed);

}  // namespace corda::pipeline
