#pragma once

#include <span>

#include "corda/sim/defs.hpp"

namespace corda::sim {

// Definitions that are filled in code have not been checked by the reader of scene files. Each function
// throws corda::Refusal for a field that is outside the range of its declaration.

void validate(std::span<const RopeDef> ropes, std::span<const NetDef> nets);
void validate(const WorldDef& world);
void validate(const MethodDef& method);

}  // namespace corda::sim
