#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/report/report.hpp"
#include "corda/study/measure.hpp"
#include "corda/study/step.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// What a study measures, and how it is ended.
struct StudyDef {
    bool quick = false;  ///< fewer points and shorter runs: to see whether it works, not to quote from
    std::optional<Scene> scene;         ///< studied instead of the built-in problems
    std::vector<std::string> chapters;  ///< some of chapter_names(); empty: all that apply
    FilmDef film;                       ///< how chapter "picture" gets to OpenGL
    OnStep on_step;                     ///< may be empty
};

/// Hears how far a study is: `done` of `total` jobs are done, and `what` is next. May be empty.
using OnJob = std::function<void(int done, int total, const std::string& what)>;

/// Hears of every chapter when it is measured.
using OnChapter = std::function<void(const report::Chapter&)>;

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

    /// Measures everything, and adds the chapters to `report` one after the other. Throws corda::Error, e.g.
    /// kInvalidScene if no method can run the scene, and what the callbacks throw; then `report` has the
    /// chapters up to there, and says in its setting why it ends and what was not measured.
    void run(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report);

  private:
    void measure(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report);

    std::string title_;
    Timing timing_;
    OnStep on_step_;
    std::vector<ChapterWork> works_;
    std::vector<std::string> names_;  ///< of the chapters of works_
};

}  // namespace corda::study
