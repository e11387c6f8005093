#include "page_folder.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"

namespace corda::app {

namespace fs = std::filesystem;

void add_force(CLI::App& command, bool& force) {
    command.add_flag("--force", force, "write into a folder that is not empty");
}

void prepare_page_folder(const std::string& path, bool force, bool dry_run) {
    std::error_code failure;
    const bool is_there = fs::exists(path, failure);
    if (is_there && !fs::is_directory(path, failure))
        throw_error(ExitCode::kIo, "{}: exists and is not a folder; choose another name", path);
    check_folder(path);
    if (dry_run && !is_there) return;
    make_folder(path);
    const bool is_empty = fs::is_empty(path, failure);
    if (failure) fail_file("read", path, failure.value());
    if (!is_empty && !force)
        throw_error(ExitCode::kIo, "{}: is not empty; give --force to replace files of the same names", path);
}

Error with_files(const Error& error, const report::ReportFolder& folder) {
    const auto& paths = folder.paths();
    const std::string files = paths.empty() ? "nothing was written"
                                            : fmt::format("{} files are written, the last of them is {}",
                                                          paths.size(), paths.front());
    return {error.code(), fmt::format("{}; {}", error.what(), files)};
}

void report_files(const Console& console, const report::ReportFolder& folder, nlohmann::json json,
                  double wall_s) {
    console.info(fmt::format("{} files in {:.3g} s", folder.paths().size(), wall_s));
    for (const std::string& path : folder.paths()) console.result(path);
    json["files"] = folder.paths();
    json["wall_s"] = wall_s;
    console.report(std::move(json));
}

}  // namespace corda::app
