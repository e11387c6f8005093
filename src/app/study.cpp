#include "corda/study/study.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/study/setting.hpp"
#include "corda/study/writers.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "study_inputs.hpp"
#include "study_picture.hpp"

namespace corda::app {
namespace {

namespace fs = std::filesystem;

struct StudyOptions {
    SceneOptions scene;
    GlOptions gl;
    std::string output;
    std::vector<std::string> chapters;
    bool quick = false;
    bool force = false;

    [[nodiscard]] bool wants(const std::string& chapter) const {
        return chapters.empty() || std::find(chapters.begin(), chapters.end(), chapter) != chapters.end();
    }
};

std::vector<std::string> all_chapters() {
    std::vector<std::string> names = study::chapter_names();
    names.emplace_back(kPictureChapter);
    return names;
}

/// Makes the folder of the report, before hours of measuring. Throws corda::Error (kIo).
void prepare_folder(const std::string& path, bool force) {
    std::error_code ignored;
    if (fs::exists(path, ignored) && !fs::is_directory(path, ignored)) {
        throw Error(ExitCode::kIo, fmt::format("{}: exists and is no folder; choose another name", path));
    }
    make_folder(path);
    const bool is_empty = fs::is_empty(path, ignored) && !ignored;
    if (!is_empty && !force) {
        throw Error(ExitCode::kIo,
                    fmt::format("{}: is not empty; give --force to replace files of the same names", path));
    }
    if (::access(path.c_str(), W_OK | X_OK) != 0) {
        throw Error(ExitCode::kIo, fmt::format("{}: nothing can be written there: {}; choose another folder",
                                               path, std::strerror(errno)));
    }
}

double longest_rope_m(const scene::Scene& scene) {
    double longest_m = 0.0;
    const sim::System system = scene::system_of(scene);
    for (const sim::Body& body : system.bodies) {
        double length_m = 0.0;
        for (std::size_t k = 0; k < body.link_count; ++k) length_m += system.bars[body.first_bar + k].rest_m;
        longest_m = std::max(longest_m, length_m);
    }
    return longest_m;
}

/// A file's name as a report's id.
std::string id_of(const std::string& name) {
    std::string id;
    for (const char c : name) {
        const bool is_upper = c >= 'A' && c <= 'Z';
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        id += is_upper ? static_cast<char>(c - 'A' + 'a') : (is_plain ? c : '_');
    }
    return id;
}

/// What a user's scene asks the solvers; the truth is left to the study.
study::Problem problem_of(const scene::Scene& scene) {
    study::Problem problem;
    problem.id = id_of(scene.name);
    problem.title = scene.name;
    problem.ropes = scene.ropes;
    problem.nets = scene.nets;
    problem.world = scene.world;
    problem.frame_interval_s = scene.video.fps.interval_s();
    problem.last_frame = scene.video.fps.last_frame_within(scene.world.duration_s);
    problem.length_m = longest_rope_m(scene);
    return problem;
}

/// Shows how far a part of the study is, and ends it where a signal asks for that.
class Watch {
  public:
    Watch(const Console& console, std::string what) : console_(console), what_(std::move(what)) {}

    void operator()(int done, int of, const std::string& now) {
        if (interruption() != ExitCode::kOk) throw Error(interruption(), "interrupted; nothing was written");
        if (!progress_) progress_ = std::make_unique<Progress>(console_, what_, of);
        if (!console_.draws_bar())
            console_.detail(fmt::format("{} {} of {}: {}", what_, std::min(done + 1, of), of, now));
        progress_->update(done);
    }

  private:
    const Console& console_;
    std::string what_;
    std::unique_ptr<Progress> progress_;
};

study::Report measure(const Console& console, const StudyOptions& options,
                      const std::optional<scene::Scene>& scene) {
    study::StudyDef def;
    def.quick = options.quick;
    def.input_cases = input_cases();
    if (scene) def.problem = problem_of(*scene);
    for (const std::string& chapter : options.chapters) {
        if (chapter != kPictureChapter) def.chapters.push_back(chapter);
    }
    study::Report report{"Corda: pictures", {}, {}};
    if (options.chapters.empty() || !def.chapters.empty()) {
        auto watch = std::make_shared<Watch>(console, "study");
        report = study::run_study(
            def, [watch](int done, int of, const std::string& what) { (*watch)(done, of, what); });
    }
    if (options.wants(kPictureChapter)) {
        auto watch = std::make_shared<Watch>(console, "pictures");
        report.chapters.push_back(picture_chapter(
            {options.quick, scene},
            [watch](int done, int of, const std::string& what) { (*watch)(done, of, what); }));
    }
    report.setting = study::setting(study::study_timing(options.quick));
    return report;
}

ExitCode study_command(const Console& console, const StudyOptions& options) {
    const double start_s = now_s();
    if (options.scene.path.empty() && !options.scene.settings.empty()) {
        throw Error(ExitCode::kUsage, "--set changes a scene; name its file too");
    }
    std::optional<scene::Scene> scene;
    if (!options.scene.path.empty()) scene = options.scene.load();
    const gl::ContextDef context_def = options.gl.def();
    prepare_folder(options.output, options.force);
    study::check_gnuplot();
    std::optional<gl::Context> context;
    if (options.wants(kPictureChapter)) {
        context.emplace(context_def);
        report_gl(console, *context);
    }
    study::Report report = measure(console, options, scene);
    if (context) report.setting.emplace_back("OpenGL", context->info().gl_renderer);
    const std::vector<std::string> paths = study::write_report(report, options.output);
    console.info(fmt::format("{} files in {:.3g} s", paths.size(), now_s() - start_s));
    for (const std::string& path : paths) console.result(path);
    console.report(
        {{"schema", 1}, {"folder", options.output}, {"files", paths}, {"wall_s", now_s() - start_s}});
    return ExitCode::kOk;
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
    auto options = std::make_shared<StudyOptions>();
    CLI::App* command = app.add_subcommand(
        "study", "measure speed against error of every method, and write a report with tables and plots");
    options->scene.add_to(*command, SceneOptions::Need::kOptional);
    command->add_option("-o,--output", options->output, "folder of the report")->required();
    command->add_flag("--quick", options->quick, "fewer and shorter runs, not to quote from");
    command->add_option("--chapter", options->chapters, "only these chapters")
        ->delimiter(',')
        ->check(CLI::IsMember(all_chapters()));
    options->gl.add_to(*command);
    command->add_flag("--force", options->force, "write into a folder that is not empty");
    command->callback([options, &action] {
        action = [options](const Console& console) { return study_command(console, *options); };
    });
}

}  // namespace corda::app
