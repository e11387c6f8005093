#pragma once

#include <cstddef>
#include <functional>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// Calls `use` with each body of a system as a system of its own and the body's index, in order. Its origin
/// is the system's; particles and bars are counted from 0. It lives for the call alone. A
/// corda::Refusal that `use` throws gets the body's name in front if there are several.
void for_each_body(const System& system, const std::function<void(const System&, std::size_t)>& use);

}  // namespace corda::sim
