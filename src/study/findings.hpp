#pragma once

#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// The chapter "The source report's findings" (section 1 of src/sim/README.md): a measurement of each, and a
/// sentence on what it says.
[[nodiscard]] ChapterWork findings_work(const StudyDef& def);

}  // namespace corda::study
