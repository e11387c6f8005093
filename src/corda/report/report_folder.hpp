#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/report/report.hpp"

namespace corda::report {

/// Writes a report into a folder chapter by chapter, so that a failure keeps the chapters that were measured
/// before. Files of other names stay. All functions throw corda::Error (kIo); a file has its name only if it
/// is complete (see OutputFile).
class ReportFolder {
  public:
    /// Makes the folder if it is missing. `widths_mm`: see Report.
    explicit ReportFolder(std::string path, OutputOptions options = {},
                          std::vector<int> widths_mm = {kPageMm});

    /// Writes the figures of a chapter: `<id>.csv` per table, then the .svg, .png and .pdf of each picture
    /// and plot. Also throws kInterrupted if cancelled.
    void add(const Chapter& chapter);

    /// Where a file of that name belongs.
    [[nodiscard]] std::string path_of(const std::string& name) const;
    /// Counts a file that other code has written there.
    void note(const std::string& path) { paths_.insert(paths_.begin(), path); }

    /// Writes setting.csv and report.html. A figure that `add` has not drawn is left out.
    void finish(Report report);

    /// The paths of the files, the last written first.
    [[nodiscard]] const std::vector<std::string>& paths() const { return paths_; }

  private:
    void write(const std::string& name, const std::string& bytes);
    /// Calls `write_as(path, format, width_mm)` for each file of a figure.
    template <class Write>
    void add_figure(const std::string& id, bool is_small, const Write& write_as);

    std::string path_;
    OutputOptions options_;
    std::vector<int> widths_mm_;
    std::map<std::string, std::string> svgs_;  ///< by plot or picture: that of the page
    std::vector<std::string> paths_;
};

}  // namespace corda::report
