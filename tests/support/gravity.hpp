#pragma once

namespace corda::test {

/// In m/s^2, the gravity of every scene without [world].gravity.
inline constexpr double kGravity = 9.81;

}  // namespace corda::test
