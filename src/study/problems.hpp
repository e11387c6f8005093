#pragma once

#include <vector>

#include "corda/study/references.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {

/// A subject and the published positions of its tip, which both of its references are checked against.
struct BuiltInProblem {
    Subject subject;
    std::vector<PublishedTip> published;
};

/// The source report's swing as a true chain: 40 particles, g = 9.8, 10 s at 60 frames a second (R11).
[[nodiscard]] BuiltInProblem report_swing();
/// IFToMM benchmark A01: a pendulum for 2000 s, in closed form (R1).
[[nodiscard]] BuiltInProblem a01_pendulum();
/// 20 links from 45 degrees for 2 s (R5).
[[nodiscard]] BuiltInProblem released_chain();
/// A chain that turns as a rigid rod without gravity for 10 s, in closed form (R8).
[[nodiscard]] BuiltInProblem spinning_chain();

/// A row of R5 as a problem of frames 1/60 s apart, whose reference knows the tip at the row's time alone.
[[nodiscard]] Problem released_problem(const ReleasedChain& row);

/// Largest distance of a reference's last particle from the published tips, over the length. Times that the
/// reference does not know are left out.
[[nodiscard]] double distance_from_published(const Problem& problem, const std::vector<PublishedTip>& tips);

}  // namespace corda::study
