#pragma once

#include <span>

#include "corda/study/measure.hpp"
#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// The run that takes least time among those whose RMS error is at most `error`; null if there is none.
[[nodiscard]] const Measurement* cheapest_within(std::span<const Measurement> runs, double error);

/// The chapter "Speed against error", on the scene of `def` or on the built-in problems.
[[nodiscard]] ChapterWork speed_work(const StudyDef& def);

}  // namespace corda::study
