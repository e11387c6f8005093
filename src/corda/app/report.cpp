#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/figures/chart.hpp"
#include "corda/figures/motion_summary.hpp"
#include "corda/figures/scene_report.hpp"
#include "corda/report/report_folder.hpp"
#include "interrupt.hpp"
#include "page_folder.hpp"

namespace corda::app {
namespace {

struct ReportOptions {
    SceneOptions scene;
    GlOptions gl;
    TimeOptions times;
    std::string output;
    bool force = false;
    bool dry_run = false;
};

/// Writes the report; returns why the motion ended early, if it did.
std::optional<Error> write_report(const Console& console, Film& film, const std::vector<RequestedTime>& times,
                                  const ReportOptions& options, report::ReportFolder& folder) {
    std::string shown;
    OnProgress progress;  // each part from its start
    figures::SceneReportDef def;
    for (const RequestedTime& time : times) def.at_s.push_back(time.time_s);
    def.output = {.force = options.force};
    def.on_part = [&](const std::string& part, std::int64_t done, std::int64_t total) {
        if (part != shown) progress = show_progress(console, part);
        shown = part;
        progress(done, total);
    };
    try {
        return figures::write_scene_report(film, def, folder);
    } catch (const Error& error) {
        progress = {};
        throw with_files(error, folder);
    }
}

ExitCode report_command(const Console& console, const ReportOptions& options) {
    const double start_s = now_s();
    Scene scene = options.scene.load(console);
    figures::prefer_paper(scene);
    const std::vector<RequestedTime> times = options.times.list(scene);
    prepare_page_folder(options.output, options.force, options.dry_run);
    OnProgress on_progress = show_progress(console, "simulate");
    FilmDef def = figures::film_def(scene);
    def.on_progress = [&](std::int64_t done, std::int64_t all) {
        return !on_progress || on_progress(done, all);
    };
    for (const RequestedTime& time : times) def.stills_s.push_back(time.time_s);
    options.gl.apply_to(def);
    Film film(scene, def);
    report_plan(console, film);
    if (options.dry_run) {
        console.info(fmt::format("would write a report into {}", options.output));
        console.report(film_json(film));
        return ExitCode::kOk;
    }
    set_interruption_message(kSomethingWritten);
    on_progress = {};
    report::ReportFolder folder(options.output, {.force = options.force},
                                {report::kColumnMm, report::kPageMm});
    const std::optional<Error> failure = write_report(console, film, times, options, folder);
    warn_of_branch(console, film);
    if (failure) throw with_files(*failure, folder);
    nlohmann::json json = film_json(film);
    json["folder"] = options.output;
    report_files(console, folder, std::move(json), now_s() - start_s);
    return ExitCode::kOk;
}

}  // namespace

void add_report(CLI::App& app, Action& action) {
    auto [command, options] =
        add_command(app, action, "report",
                    "write the figures that a paper needs of a scene, for print, and a page with all of them",
                    report_command);
    options.scene.add_to(command);
    command.add_option("-o,--output", options.output, "folder of the report")->required();
    options.times.add_to(command);
    options.scene.add_timing(command, "rows per second");
    options.gl.add_to(command);
    add_force(command, options.force);
    command.add_flag("--dry-run", options.dry_run, "check everything and write nothing");
}

}  // namespace corda::app
