#pragma once

#include "corda/reference/numbers.hpp"
#include "corda/scene/scene.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {

/// The source report's swing as a true chain: 40 particles, g = 9.8 m/s^2, 10 s (the start of R11).
[[nodiscard]] Problem report_swing();
/// IFToMM benchmark A01: a pendulum for 2000 s, with its closed form (R1).
[[nodiscard]] Problem a01_pendulum();
/// 20 links from 45 degrees for 2 s (a start of R5).
[[nodiscard]] Problem released_chain();
/// A chain that turns like a rigid rod without gravity for 10 s, with its closed form (R8).
[[nodiscard]] Problem spinning_chain();

/// A row of R5, whose reference knows only the tip at the row's time.
[[nodiscard]] Problem released_problem(const reference::ReleasedChain& row);

/// A scene without imaginary bars; its truth is left to find_truth().
[[nodiscard]] Problem problem_of(const Scene& scene);

}  // namespace corda::study
