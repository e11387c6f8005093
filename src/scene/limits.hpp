#pragma once

#include <cstdint>
#include <vector>

#include "corda/scene/readers.hpp"

namespace corda::scene {

/// The particles of every rope. Throws kInvalidScene where all together, or the bars between them, are too
/// many.
[[nodiscard]] std::vector<std::int64_t> count_particles(const Sections& sections,
                                                        const sim::SolverDef& solver);

/// Throws kInvalidScene where the video has no frame or too many, or the simulation would take too many steps
/// or bar updates for ropes of `particles`.
void check_work(const Sections& sections, const Scene& scene, const std::vector<std::int64_t>& particles);

}  // namespace corda::scene
