#pragma once

#include <optional>
#include <vector>

#include "corda/scene/readers.hpp"

namespace corda::scene {

struct SceneSize {
    std::vector<std::optional<BodySize>> bodies;  ///< ropes, then nets; empty if not known
    bool has_bars = false;                        ///< whether the bars of all bodies are known
    bool fits = true;                             ///< whether they are within the limits
};

/// Counts particles and bars without making any. Too many particles, bars or points of trails of all
/// bodies together are a problem.
[[nodiscard]] SceneSize count_bodies(const Sections& sections, const SolverSection& solver,
                                     const Scene& scene);

/// Adds a problem if the video has no frame or too many, or the simulation would take too many steps or bar
/// updates, by each body's own method.
void check_work(const Sections& sections, const SolverSection& solver, const SceneSize& size,
                const Scene& scene);

}  // namespace corda::scene
