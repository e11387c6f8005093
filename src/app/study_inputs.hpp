#pragma once

#include <vector>

#include "corda/study/hard_case.hpp"

namespace corda::app {

/// The hard cases of PHYSICS section 5 that a scene file must not get past its reader.
[[nodiscard]] std::vector<study::HardCase> input_cases();

}  // namespace corda::app
