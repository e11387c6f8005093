#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/defs.hpp"
#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/film.hpp"
#include "interrupt.hpp"
#include "shots.hpp"

namespace corda::app {
namespace {

struct StillOptions {
    SceneOptions scene;
    GlOptions gl;
    EmptyPictures empty;
    ShotOptions shots;
    std::string output;
    double pixels_per_inch = 96.0;
    bool force = false;
    bool dry_run = false;
};

struct Still : Shot {
    std::string path;
};

/// Whether the output is one picture. A name with an ending is meant as a file; folders have none, or exist,
/// or end with a slash.
bool is_picture(const std::string& output) {
    const std::filesystem::path path(output);
    if (path.extension() == ".png") return true;
    if (output != "-" && (!path.has_extension() || std::filesystem::is_directory(path))) return false;
    throw Error(ExitCode::kUsage,
                fmt::format("-o {}: stills are written as .png; give such a name, or a folder "
                            "(ending with / if its name has a dot)",
                            output));
}

/// What a folder calls it: names that sort by time, with one dot, so that no program takes a part of the
/// time for the ending.
std::string name_of(const Shot& shot, const Scene& scene) {
    std::string name = shot.frame ? fmt::format("{}_f{:06}", scene.name, *shot.frame)
                                  : fmt::format("{}_t{:011.6f}", scene.name, shot.time_s);
    std::replace(name.begin(), name.end(), '.', '_');
    return name + ".png";
}

std::vector<Still> list_stills(const StillOptions& options, const Scene& scene) {
    std::vector<Still> stills;
    for (const Shot& shot : options.shots.list(scene)) stills.push_back({shot, name_of(shot, scene)});
    const auto same = std::adjacent_find(stills.begin(), stills.end(),
                                         [](const Still& a, const Still& b) { return a.path == b.path; });
    if (same != stills.end()) {
        throw Error(ExitCode::kUsage,
                    fmt::format("two stills would both be {}; ask for each time once", same->path));
    }
    return stills;
}

void set_paths(const StillOptions& options, std::vector<Still>& stills) {
    if (is_picture(options.output)) {
        if (stills.size() != 1) {
            throw Error(ExitCode::kUsage, fmt::format("-o {}: is one file for {} stills; give a folder",
                                                      options.output, stills.size()));
        }
        stills.front().path = options.output;
    } else {
        for (Still& still : stills)
            still.path = (std::filesystem::path(options.output) / still.path).string();
        if (!options.dry_run) make_folder(options.output);
    }
    if (options.dry_run && !std::filesystem::is_directory(options.output)) return;
    for (const Still& still : stills) check_output(still.path, options.scene.path, options.force);
}

PngInfo describe_still(const Still& still, const Scene& scene, double pixels_per_inch) {
    PngInfo info;
    info.pixels_per_inch = pixels_per_inch;
    info.text = {{"Software", "corda " CORDA_VERSION},
                 {"Title", printable(scene.name)},
                 {"Time", fmt::format("{} s", still.time_s)}};
    if (still.frame) info.text.emplace_back("Frame", fmt::format("{}", *still.frame));
    return info;
}

/// Draws and writes the stills, and counts the empty ones. If interrupted, the message says how many were
/// written.
void write_stills(const std::vector<Still>& stills, const StillOptions& options, const Film& film,
                  EmptyPictures& empty) {
    std::size_t written = 0;
    try {
        for (const Still& still : stills) {
            stop_if_asked();
            write_png(still.path, film.still(still.time_s, stopping_if_asked()),
                      describe_still(still, film.scene(), options.pixels_per_inch),
                      {.force = options.force, .on_progress = stopping_if_asked()});
            ++written;
            if (film.shows_nothing() && empty.count++ == 0) empty.first_s = still.time_s;
        }
    } catch (const Error& error) {
        if (written == 0 || error.code() != interruption()) throw;
        throw Error(error.code(), fmt::format("interrupted: {} of {} stills are written, the last of them {}",
                                              written, stills.size(), stills[written - 1].path));
    }
}

ExitCode write_stills(const Console& console, const StillOptions& options) {
    Scene scene = options.scene.load();
    std::vector<Still> stills = list_stills(options, scene);
    set_paths(options, stills);
    FilmDef def;
    def.on_progress = show_progress(console, "simulate");
    for (const Still& still : stills) def.stills_s.push_back(still.time_s);
    options.gl.apply_to(def);
    const Film film(scene, def);
    report_plan(console, film);
    console.detail(fmt::format("{}: {}", film.scene().name, describe(film.system())));
    static_cast<void>(film.camera());
    EmptyPictures empty = options.empty;
    if (!options.dry_run) {
        report_gl(console, film.gl());
        write_stills(stills, options, film, empty);
    }
    nlohmann::json json = film_json(film);
    json["outputs"] = nlohmann::json::array();
    for (const Still& still : stills) {
        if (options.dry_run) console.info(fmt::format("would write {}", still.path));
        if (!options.dry_run) console.result(still.path);
        json["outputs"].push_back({{"path", still.path}, {"time_s", still.time_s}});
    }
    json["width"] = film.scene().video.width_px;
    json["height"] = film.scene().video.height_px;
    json["empty"] = empty.count;
    console.report(json);
    return empty.report(console, static_cast<std::int64_t>(stills.size()));
}

}  // namespace

void add_still(CLI::App& app, Action& action) {
    auto options = std::make_shared<StillOptions>();
    CLI::App* command = app.add_subcommand("still", "draw frames at exact times as PNG files");
    options->scene.add_to(*command);
    options->shots.add_to(*command);
    command->add_option("-o,--output", options->output, "folder, or a .png file for one still")->required();
    options->scene.add_size(*command);
    options->scene.add_shortcut(*command, "--fps", "video.fps", "frames per second");
    options->scene.add_shortcut(*command, "--duration", "world.duration", "seconds");
    command->add_option("--ppi", options->pixels_per_inch, "pixels per inch, for the size in print")
        ->check(within(1.0, 10000.0));
    options->gl.add_to(*command);
    options->empty.add_to(*command);
    command->add_flag("--force", options->force, "replace existing files");
    command->add_flag("--dry-run", options->dry_run, "check everything and write nothing");
    command->callback([options, &action] {
        options->shots.require();
        action = [options](const Console& console) { return write_stills(console, *options); };
    });
}

}  // namespace corda::app
