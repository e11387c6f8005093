#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/report/report.hpp"
#include "corda/study/measure.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// What a study measures.
struct StudyDef {
    bool quick = false;  ///< fewer points and shorter runs: to see whether it works, not to quote from
    std::optional<Scene> scene;         ///< studied instead of the built-in problems
    std::vector<std::string> chapters;  ///< some of chapter_names(); empty: all that apply
    FilmDef film;                       ///< how chapter "picture" gets to OpenGL
};

/// Hears how far a study is: `done` of `total` jobs are done, and `what` is next. What it throws ends the
/// study.
using OnJob = std::function<void(int done, int total, const std::string& what)>;

/// The names of the chapters, [a-z0-9_]+, in the order of the report.
[[nodiscard]] std::vector<std::string> chapter_names();

/// How a study times its runs.
[[nodiscard]] Timing study_timing(bool quick);

/// A study that has been checked and is ready to run.
class Study {
  public:
    /// Throws corda::Error: kUsage for an unknown chapter, or one that does not apply to a scene; kNoGl if
    /// chapter "picture" is wanted and cannot be drawn.
    explicit Study(const StudyDef& def);

    /// Measures everything. Throws corda::Error, e.g. kInvalidScene if no method can run the scene.
    [[nodiscard]] report::Report run(const OnJob& on_job);

  private:
    std::string title_;
    Timing timing_;
    std::vector<ChapterWork> works_;
};

}  // namespace corda::study
