#pragma once

#include "corda/core/stop_check.hpp"

namespace corda::test {

/// For solvers that are to go on whatever happens.
inline StopCheck unstopped;

}  // namespace corda::test
