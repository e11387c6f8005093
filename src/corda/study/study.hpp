#pragma once

#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/report/report.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {

/// The parameters of a study.
struct StudyDef {
    bool quick = false;  ///< fewer points and shorter runs: to see whether it works, not to quote from
    std::optional<Scene> scene;         ///< studied instead of the built-in problems
    std::vector<std::string> chapters;  ///< some of chapter_names(); empty: all that apply
};

/// A run of a chapter, or several that belong together.
struct Job {
    std::string what;  ///< for progress messages
    std::function<void()> run;
};

/// A chapter before its measurement: its jobs in order, and `finish`, which makes the chapter from their
/// results. They share their data.
struct ChapterWork {
    std::vector<Job> jobs;
    std::function<report::Chapter()> finish;
};

/// Progress of a study: `done` of `total` jobs are done, and `what` is next. May be empty.
using OnJob = std::function<void(int done, int total, const std::string& what)>;

/// Called with every chapter after its measurement.
using OnChapter = std::function<void(const report::Chapter&)>;

/// The names of the chapters, [a-z0-9_]+, in the order of the report.
[[nodiscard]] std::vector<std::string> chapter_names();

/// The chapter "The source report's findings" (section 1 of src/corda/sim/README.md): a measurement of each.
[[nodiscard]] ChapterWork findings_work(const StudyDef& def);

[[nodiscard]] Timing study_timing(bool quick);

/// A study that has been checked and is ready to run.
class Study {
  public:
    /// Throws corda::Error (kUsage) for an unknown chapter, or one that does not apply to a scene.
    explicit Study(const StudyDef& def);

    /// Measures everything in this thread, which can cancel it, and adds the chapters to `report` one after
    /// the other. Throws corda::Error, e.g. kInvalidScene if no method can run the scene, and any exception
    /// of a callback; then `report` has the chapters up to there, and its setting has the reason and the
    /// chapters that were not measured.
    void run(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report);

  private:
    void measure(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report);

    std::string title_;
    Timing timing_;
    std::vector<ChapterWork> works_;
    std::vector<std::string> names_;  ///< of the chapters of works_
};

/// The machine and the timing of a study, for Report::setting: processor, cores, compiler, build, version of
/// Corda, and `timing` in words. No dates, users or folders.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> setting(const Timing& timing);

/// The processor's name in the text of /proc/cpuinfo; "unknown" if it has none.
[[nodiscard]] std::string processor_name(std::istream& cpuinfo);

}  // namespace corda::study
