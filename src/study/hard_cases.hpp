#pragma once

#include <vector>

#include "corda/study/hard_case.hpp"
#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// Motions: payloads, releases, throws, inverted and folded ropes, unequal links and masses.
void add_hard_motions(std::vector<HardCase>& cases);
/// Sizes and steps: long ropes, long runs, steps of any size, refusals, frame rates, repeated runs.
void add_hard_sizes(std::vector<HardCase>& cases);

/// The chapter "Hard cases".
[[nodiscard]] ChapterWork hard_cases_work(const StudyDef& def);

}  // namespace corda::study
