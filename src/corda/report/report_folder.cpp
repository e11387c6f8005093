#include "corda/report/report_folder.hpp"

#include <filesystem>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {

ReportFolder::ReportFolder(std::string path, OutputOptions options, std::vector<int> widths_mm)
    : path_(std::move(path)), options_(options), widths_mm_(std::move(widths_mm)) {
    make_folder(path_);
}

std::string ReportFolder::path_of(const std::string& name) const {
    return (std::filesystem::path(path_) / name).string();
}

void ReportFolder::write(const std::string& name, const std::string& bytes) {
    const std::string path = path_of(name);
    save_file(path, bytes, options_);
    note(path);
}

template <class Write>
void ReportFolder::add_figure(const std::string& id, bool is_small, const Write& write_as) {
    // What is small on the page is read with the letters of the narrow one.
    const int shown_mm = is_small ? widths_mm_.front() : widths_mm_.back();
    for (const int width_mm : widths_mm_) {
        for (const PlotFormat format : {PlotFormat::kSvg, PlotFormat::kPng, PlotFormat::kPdf}) {
            check_cancelled();
            const std::string path = path_of(file_stem(id, width_mm, widths_mm_) + "." + ending(format));
            write_as(path, format, width_mm);
            note(path);
            if (format == PlotFormat::kSvg && width_mm == shown_mm) svgs_[id] = file_bytes(path);
        }
    }
}

void ReportFolder::add(const Chapter& chapter) {
    for (const Table& table : chapter.tables) write(table.id + ".csv", csv_text(table));
    for (const Picture& picture : chapter.pictures)
        add_figure(picture.id, picture.is_small,
                   [&](const std::string& path, PlotFormat, int width_mm) { picture.write(path, width_mm); });
    for (const Plot& plot : chapter.plots)
        add_figure(plot.id, false, [&](const std::string& path, PlotFormat format, int width_mm) {
            save_file(path, draw_plot(plot, format, width_mm), options_);
        });
}

void ReportFolder::finish(Report report) {
    report.widths_mm = widths_mm_;
    const auto is_missing = [this](const auto& figure) { return !svgs_.contains(figure.id); };
    for (Chapter& chapter : report.chapters) {
        std::erase_if(chapter.plots, is_missing);
        std::erase_if(chapter.pictures, is_missing);
    }
    Table setting{"setting", "Setting", {{"name", "What"}, {"value", "Value"}}, {}, ""};
    for (const auto& [name, value] : report.setting) setting.add({name, value});
    write("setting.csv", csv_text(setting));
    write("report.html", html_text(report, [this](const std::string& id) { return svgs_.at(id); }));
}

}  // namespace corda::report
