#pragma once

namespace corda::test {

/// m/s^2, as every scene without [world].gravity has it.
inline constexpr double kGravity = 9.81;

}  // namespace corda::test
