#pragma once

#include <string>

#include "corda/sim/defs.hpp"

namespace corda {

/// The keys of a scene file that name a method, one per line, but for the reach of its bars: the shortest
/// texts that read back to the same bits. `method` has every default filled in.
[[nodiscard]] std::string solver_toml(const MethodDef& method);

}  // namespace corda
