#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include <string>

#include "console.hpp"
#include "corda/core/basics.hpp"
#include "corda/report/report_folder.hpp"

namespace corda::app {

// The folder that `report` writes a page with its figures into.

/// Its `--force`.
void add_force(CLI::App& command, bool& force);

/// Makes it before hours of computing; `dry_run`: only checks one that is there. Throws corda::Error (kIo) if
/// it cannot be written to, or is not empty and `force` is not set.
void prepare_page_folder(const std::string& path, bool force, bool dry_run = false);

/// An error that ended it early, with the names of the files written.
[[nodiscard]] Error with_files(const Error& error, const report::ReportFolder& folder);

/// Prints its files, the page first; `json` gets them too.
void report_files(const Console& console, const report::ReportFolder& folder, nlohmann::json json,
                  double wall_s);

}  // namespace corda::app
