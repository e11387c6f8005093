#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/report/report_folder.hpp"

namespace corda::figures {

/// How a report of a scene is made.
struct SceneReportDef {
    std::vector<double> at_s;  ///< times of its strobe and stills, increasing; empty: see find_figure_times()
    OutputOptions output;
    /// Told which part is next, and what there is to do in it. May be empty.
    std::function<void(const std::string& part, std::int64_t done, std::int64_t total)> on_part;
};

/// Writes the report of a film, with film_def(), into a folder: CSVs with a row per frame
/// time, figures, and the pages. If a motion diverges, the report shows the part before that, and the error
/// is returned. If it is cancelled, the pages have the figures that are drawn. Throws
/// corda::Error: kIo, kNoGl, kDiverged if there is no state at all, kInterrupted.
[[nodiscard]] std::optional<Error> write_scene_report(Film& film, const SceneReportDef& def,
                                                      report::ReportFolder& folder);

}  // namespace corda::figures
