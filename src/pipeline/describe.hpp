#pragma once

#include <string>

#include "corda/core/basics.hpp"
#include "corda/sim/refusal.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda {

/// What a scene amounts to: "40 particles, 252 bars (39 real)".
[[nodiscard]] std::string describe(const System& system);

/// A method in words: "exact at tolerance 1e-08".
[[nodiscard]] std::string describe(const MethodDef& method);

/// Why a plan runs its method, as a clause.
[[nodiscard]] std::string describe(const Plan& plan);

namespace pipeline {

/// The refusal of a scene: names its file (Scene::source), the problem, and which keys to change.
[[nodiscard]] Error explained(const Refusal& refusal, const std::string& source);

}  // namespace pipeline
}  // namespace corda
