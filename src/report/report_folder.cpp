#include "corda/report/report_folder.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include "corda/core/output_file.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {

ReportFolder::ReportFolder(std::string path, OutputOptions options)
    : path_(std::move(path)), options_(std::move(options)) {
    make_folder(path_);
}

void ReportFolder::write(const std::string& name, const std::string& bytes) {
    const std::string path = (std::filesystem::path(path_) / name).string();
    OutputFile output(path, options_);
    output.write(bytes);
    output.commit();
    paths_.insert(paths_.begin(), path);
}

void ReportFolder::add(const Chapter& chapter) {
    check_report({{}, {}, {chapter}});
    for (const Table& table : chapter.tables) write(table.id + ".csv", csv_text(table));
    for (const Plot& plot : chapter.plots) {
        for (const PlotFormat format : {PlotFormat::kSvg, PlotFormat::kPng, PlotFormat::kPdf}) {
            report_progress(options_.on_progress, std::ssize(svgs_), std::ssize(chapter.plots));
            const std::string picture = draw_plot(plot, format);
            write(plot.id + "." + ending(format), picture);
            if (format == PlotFormat::kSvg) svgs_[plot.id] = picture;
        }
    }
}

void ReportFolder::finish(Report report) {
    check_report(report);
    for (Chapter& chapter : report.chapters)
        std::erase_if(chapter.plots, [this](const Plot& plot) { return !svgs_.contains(plot.id); });
    const std::string page = html_text(report, [this](const Plot& plot) { return svgs_.at(plot.id); });
    const std::array<std::pair<const char*, std::string>, 3> files{
        {{"report.md", markdown_text(report)}, {"report.json", json_text(report)}, {"report.html", page}}};
    std::optional<Error> failure;
    for (const auto& [name, bytes] : files) {
        try {
            write(name, bytes);
        } catch (const Error& error) {
            if (!failure) failure = error;
        }
    }
    if (failure) throw Error(*failure);
}

}  // namespace corda::report
