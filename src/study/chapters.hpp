#pragma once

#include "corda/study/study.hpp"

namespace corda::study {

/// The chapter "The source report's findings" (section 1 of src/sim/README.md): a measurement of each, and a
/// sentence on what it says.
[[nodiscard]] ChapterWork findings_work(const StudyDef& def);

/// The chapter "Pictures", on the scene of `def` or on the source report's swing: the time of a whole render
/// against the displayed error of several methods. Throws corda::Error (kNoGl, kUsage) if OpenGL cannot be
/// used.
[[nodiscard]] ChapterWork pictures_work(const StudyDef& def);

}  // namespace corda::study
