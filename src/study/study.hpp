#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/study/hard_case.hpp"
#include "corda/study/measure.hpp"
#include "corda/study/report.hpp"

namespace corda::study {

/// What a study looks into.
struct StudyDef {
    bool quick = false;  ///< fewer points, shorter runs: to see whether it works, not to quote from
    /// A problem to study in place of the built-in ones. Where its `reference` is empty, one is made by a far
    /// tighter run of another formulation.
    std::optional<Problem> problem;
    std::vector<std::string> chapters;  ///< names out of chapter_names(); empty: all that apply
    std::vector<HardCase> input_cases;  ///< hard cases of what this library never sees: scene files
};

/// Key of the column that says why a run failed: a row with a text in it is shown as failed by every writer.
inline constexpr std::string_view kFailureKey = "failure";

/// Hears how far a study is: `done` of `of` runs, `what` in words. What it throws ends the study.
using Progress = std::function<void(int done, int of, const std::string& what)>;

/// The names by which chapters are asked for, in the order of a report: [a-z0-9_]+.
[[nodiscard]] std::vector<std::string> chapter_names();

/// How the runs of a study are timed.
[[nodiscard]] Timing study_timing(bool quick);

/// Runs a study: title and chapters of its report; `setting` is left empty (setting.hpp fills it). Throws
/// corda::Error: kUsage for an unknown chapter, kInvalidScene for a problem that no method can run.
[[nodiscard]] Report run_study(const StudyDef& def, const Progress& progress);

}  // namespace corda::study
