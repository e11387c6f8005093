#include "corda/study/study.hpp"

#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/report/report_folder.hpp"
#include "interrupt.hpp"
#include "page_folder.hpp"

namespace corda::app {
namespace {

struct StudyOptions {
    SceneOptions scene;
    std::string output;
    study::StudyDef def;
    bool force = false;
};

/// Measures everything and writes each chapter when it is measured. What ends the study early is thrown when
/// the report of the chapters before it is written.
void measure(const Console& console, study::Study& study, report::ReportFolder& folder) {
    std::unique_ptr<Progress> progress;
    const auto on_job = [&](int done, int total, const std::string& what) {
        if (!progress) progress = std::make_unique<Progress>(console, "study", total);
        if (!console.draws_bar() && done < total)
            console.detail(fmt::format("study {} of {}: {}", done + 1, total, what));
        progress->update(done);
    };
    report::Report report;
    std::optional<Error> failure;
    try {
        study.run(
            on_job, [&](const report::Chapter& chapter) { folder.add(chapter); }, report);
    } catch (const Error& error) {
        failure = error;
    }
    progress.reset();
    try {
        if (!report.chapters.empty()) folder.finish(report);
    } catch (const Error& error) {
        if (!failure) failure = error;
    }
    if (!failure) return;
    throw with_files(*failure, folder);
}

ExitCode study_command(const Console& console, StudyOptions options) {
    const double start_s = now_s();
    if (!options.scene.path.empty()) {
        options.def.scene = options.scene.load(console);
    } else if (!options.scene.settings.empty()) {
        throw Error(ExitCode::kUsage, "--set changes a scene; name its file");
    }
    study::Study study(options.def);
    prepare_page_folder(options.output, options.force);
    set_interruption_message(kSomethingWritten);
    report::ReportFolder folder(options.output, {.force = options.force});
    measure(console, study, folder);
    report_files(console, folder, {{"schema", 1}, {"folder", options.output}}, now_s() - start_s);
    return ExitCode::kOk;
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
    auto [command, options] =
        add_command(app, action, "study",
                    "measure speed against error of every method, and write a report with tables and plots",
                    study_command);
    options.scene.add_to(command, SceneOptions::Need::kOptional);
    command.add_option("-o,--output", options.output, "folder of the report")->required();
    command.add_flag("--quick", options.def.quick, "fewer and shorter runs, not to quote from");
    command
        .add_option("--chapter", options.def.chapters,
                    fmt::format("only these chapters: {}", fmt::join(study::chapter_names(), ", ")))
        ->delimiter(',')
        ->type_name("NAME");
    add_force(command, options.force);
}

}  // namespace corda::app
