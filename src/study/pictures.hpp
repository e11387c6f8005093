#pragma once

#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// The chapter "Pictures", on the scene of `def` or on the source report's swing: the time of a whole render
/// against the displayed error of several methods, and x264's presets against what the encoding loses. Throws
/// corda::Error (kNoGl, kUsage) if OpenGL cannot be used.
[[nodiscard]] ChapterWork pictures_work(const StudyDef& def);

}  // namespace corda::study
