#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/report/report.hpp"

namespace corda::report {

/// Writes a report into a folder chapter by chapter, so that what was measured for hours is not lost with
/// what comes after it. Files of other names stay. All functions throw corda::Error (kIo), and kInternal for
/// a report that breaks the rules of report.hpp (check_report); a file has its name only if it is complete
/// (see OutputFile).
class ReportFolder {
  public:
    /// Makes the folder if it is missing. `options.on_progress` is asked between pictures.
    explicit ReportFolder(std::string path, OutputOptions options = {});

    /// Writes the figures of a chapter: `<id>.csv` per table, then `<id>.svg`, `.png` and `.pdf` per plot.
    /// Also throws kInterrupted if it is asked to stop.
    void add(const Chapter& chapter);

    /// Writes report.md, report.json and report.html. A plot of which `add` has not drawn the picture is left
    /// out. A file that cannot be written does not keep the others from being written.
    void finish(Report report);

    /// The paths of the files, the last written first.
    [[nodiscard]] const std::vector<std::string>& paths() const { return paths_; }

  private:
    void write(const std::string& name, const std::string& bytes);

    std::string path_;
    OutputOptions options_;
    std::map<std::string, std::string> svgs_;  ///< by plot
    std::vector<std::string> paths_;
};

}  // namespace corda::report
