#include <filesystem>
#include <map>

#include "corda/core/output_file.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

struct NamedFile {
    std::string name;
    std::string bytes;
};

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

std::vector<std::string> write_report(const Report& report, const std::string& folder,
                                      OutputOptions options) {
    check_report(report);
    const std::vector<NamedFile> files = make_files(report);
    make_folder(folder);
    std::vector<std::string> paths;
    for (const NamedFile& file : files) {
        const std::string path = (std::filesystem::path(folder) / file.name).string();
        OutputFile output(path, options);
        output.write(file.bytes);
        output.commit();
        paths.insert(paths.begin(), path);
    }
    return paths;
}

}  // namespace corda::report
