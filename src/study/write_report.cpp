#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "corda/core/error.hpp"
#include "corda/study/writers.hpp"

namespace corda::study {
namespace {

namespace fs = std::filesystem;

struct NamedFile {
    std::string name;
    std::string bytes;
};

struct FileCloser {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

void write_file(const std::string& path, const std::string& bytes) {
    const std::string part = path + ".part";
    const auto fail = [&part](const char* action) {
        throw Error(ExitCode::kIo, fmt::format("{}: {} failed: {}", part, action, std::strerror(errno)));
    };
    std::unique_ptr<std::FILE, FileCloser> file(std::fopen(part.c_str(), "wbe"));
    if (!file) fail("opening");
    if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) fail("writing");
    if (std::fclose(file.release()) != 0) fail("closing");
    std::error_code reason;
    fs::rename(part, path, reason);
    if (reason) {
        throw Error(ExitCode::kIo,
                    fmt::format("{}: cannot be renamed to {}: {}", part, path, reason.message()));
    }
}

/// All files of a report; the page, which stands for the whole, comes last.
std::vector<NamedFile> make_files(const Report& report) {
    std::vector<NamedFile> files;
    std::map<std::string, std::string> svgs;
    for (const Chapter& chapter : report.chapters) {
        for (const Table& table : chapter.tables) files.push_back({table.id + ".csv", csv_text(table)});
        for (const Plot& plot : chapter.plots) {
            svgs[plot.id] = draw_plot(plot, PlotFormat::kSvg);
            files.push_back({plot.id + ".svg", svgs[plot.id]});
            files.push_back({plot.id + ".png", draw_plot(plot, PlotFormat::kPng)});
        }
    }
    files.push_back({"report.md", markdown_text(report)});
    files.push_back({"report.json", json_text(report)});
    files.push_back(
        {"report.html", html_text(report, [&svgs](const Plot& plot) { return svgs.at(plot.id); })});
    return files;
}

}  // namespace

std::vector<std::string> write_report(const Report& report, const std::string& folder) {
    check_report(report);
    const std::vector<NamedFile> files = make_files(report);
    std::error_code reason;
    fs::create_directories(folder, reason);
    if (reason) {
        throw Error(ExitCode::kIo, fmt::format("{}: cannot make the folder: {}", folder, reason.message()));
    }
    std::vector<std::string> paths;
    for (const NamedFile& file : files) {
        const std::string path = (fs::path(folder) / file.name).string();
        write_file(path, file.bytes);
        paths.insert(paths.begin(), path);
    }
    return paths;
}

}  // namespace corda::study
