#pragma once

#include "corda/core/stop_check.hpp"

namespace corda::test {

/// For solvers that must never be stopped.
inline StopCheck unstopped;

}  // namespace corda::test
