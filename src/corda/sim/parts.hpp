#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// Particles of a body, and the bars among them that are left at its start.
struct PartOfBody {
    std::vector<std::uint32_t> particles;  ///< as numbers in the body, in the order of the part's own
    std::vector<std::size_t> bars;         ///< the same of bars; real ones come first
    bool is_chain = false;                 ///< see Body::is_chain
    bool is_loose = false;                 ///< no bar joins a free particle
};

/// The parts that bars hold together; a path of links has its particles in the order of the path. All loose
/// particles are the last part.
[[nodiscard]] std::vector<PartOfBody> connected_parts(const System& body);

/// All of it as one part.
[[nodiscard]] PartOfBody whole_of(const System& body);

/// The part as a system of its own, without events.
[[nodiscard]] System system_of(const System& body, const PartOfBody& part);

}  // namespace corda::sim
