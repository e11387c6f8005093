#pragma once

#include <optional>
#include <string>

#include "corda/scene/scene.hpp"

namespace corda::figures {

/// The period of a scene by theory.
struct PeriodTheory {
    double period_s = 0.0;
    std::string model;  ///< "a point pendulum of this amplitude"
};

/// The theory of a scene that swings through `angle_deg`: of a point pendulum (R2), of a rigid rod (R3),
/// which bars to more than the next particle make of a rope, or of a hanging rope at small angles (R4). The
/// rope hangs from its first particle, without drag, and has equal masses and links. std::nullopt for other
/// scenes.
[[nodiscard]] std::optional<PeriodTheory> period_theory(const Scene& scene, double angle_deg);

}  // namespace corda::figures
