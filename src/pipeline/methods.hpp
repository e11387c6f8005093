#pragma once

#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/auto/planner.hpp"

namespace corda::pipeline {

/// The method of each body; std::nullopt if the planner chooses it.
[[nodiscard]] sim::NamedMethods named_methods(const Scene& scene);

/// The methods if each body has one; empty otherwise.
[[nodiscard]] std::vector<MethodDef> if_all_named(const sim::NamedMethods& named);

}  // namespace corda::pipeline
