#pragma once

#include <cstddef>
#include <functional>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// Calls `use` with each body of a system as a system of its own and the body's index, in order. Its origin
/// is the system's; particles and bars are counted from 0. It lives for the call alone.
void for_each_body(const System& system, const std::function<void(const System&, std::size_t)>& use);

}  // namespace corda::sim
