#pragma once

#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// The chapter "The source report's findings": each measured, with a sentence on what the figures say of it.
[[nodiscard]] ChapterWork findings_work(const StudyDef& def);

}  // namespace corda::study
