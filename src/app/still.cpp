#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

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

namespace corda::app {
namespace {

struct StillOptions {
    SceneOptions scene;
    GlOptions gl;
    EmptyPictures empty;
    std::vector<double> times_s;
    std::vector<std::int64_t> frames;
    std::string output;
    double pixels_per_inch = 96.0;
    bool force = false;
    bool dry_run = false;
};

struct Shot {
    double time_s = 0.0;
    std::optional<std::int64_t> frame;
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

std::vector<Shot> list_shots(const StillOptions& options, const Scene& scene) {
    std::vector<Shot> shots;
    for (const double time_s : options.times_s) {
        if (!std::isfinite(time_s) || time_s < 0.0 || time_s > scene.world.duration_s) {
            throw Error(ExitCode::kUsage,
                        fmt::format("--at {}: is not within 0 .. {} s; world.duration sets the end", time_s,
                                    scene.world.duration_s));
        }
        shots.push_back({time_s, std::nullopt, fmt::format("{}_t{:011.6f}.png", scene.name, time_s)});
    }
    const std::int64_t last = scene.video.fps.frame_count(scene.world.duration_s) - 1;
    for (const std::int64_t frame : options.frames) {
        if (frame < 0 || frame > last) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--frame {}: is not within 0 .. {}; world.duration sets the end", frame, last));
        }
        shots.push_back(
            {scene.video.fps.time_s(frame), frame, fmt::format("{}_f{:06}.png", scene.name, frame)});
    }
    std::stable_sort(shots.begin(), shots.end(),
                     [](const Shot& a, const Shot& b) { return a.time_s < b.time_s; });
    const auto same = std::adjacent_find(shots.begin(), shots.end(),
                                         [](const Shot& a, const Shot& b) { return a.path == b.path; });
    if (same != shots.end()) {
        throw Error(ExitCode::kUsage,
                    fmt::format("two stills would both be {}; ask for each time once", same->path));
    }
    return shots;
}

void set_paths(const StillOptions& options, std::vector<Shot>& shots) {
    if (is_picture(options.output)) {
        if (shots.size() != 1) {
            throw Error(ExitCode::kUsage, fmt::format("-o {}: is one file for {} stills; give a folder",
                                                      options.output, shots.size()));
        }
        shots.front().path = options.output;
    } else {
        for (Shot& shot : shots) shot.path = (std::filesystem::path(options.output) / shot.path).string();
        if (!options.dry_run) make_folder(options.output);
    }
    if (options.dry_run && !std::filesystem::is_directory(options.output)) return;
    for (const Shot& shot : shots) check_output(shot.path, options.scene.path, options.force);
}

PngInfo describe_shot(const Shot& shot, const Scene& scene, double pixels_per_inch) {
    PngInfo info;
    info.pixels_per_inch = pixels_per_inch;
    info.text = {{"Software", "corda " CORDA_VERSION},
                 {"Title", printable(scene.name)},
                 {"Time", fmt::format("{} s", shot.time_s)}};
    if (shot.frame) info.text.emplace_back("Frame", fmt::format("{}", *shot.frame));
    return info;
}

/// Draws and writes the stills, and counts the empty ones. If interrupted, the message says how many were
/// written.
void write_shots(const std::vector<Shot>& shots, const StillOptions& options, const Film& film,
                 EmptyPictures& empty) {
    std::size_t written = 0;
    try {
        for (const Shot& shot : shots) {
            stop_if_asked();
            write_png(shot.path, film.still(shot.time_s, stopping_if_asked()),
                      describe_shot(shot, film.scene(), options.pixels_per_inch),
                      {.force = options.force, .on_progress = stopping_if_asked()});
            ++written;
            if (film.shows_nothing() && empty.count++ == 0) empty.first_s = shot.time_s;
        }
    } catch (const Error& error) {
        if (written == 0 || error.code() != interruption()) throw;
        throw Error(error.code(), fmt::format("interrupted: {} of {} stills are written, the last of them {}",
                                              written, shots.size(), shots[written - 1].path));
    }
}

ExitCode still(const Console& console, const StillOptions& options) {
    Scene scene = options.scene.load();
    std::vector<Shot> shots = list_shots(options, scene);
    set_paths(options, shots);
    FilmDef def;
    def.on_progress = show_progress(console, "simulate");
    for (const Shot& shot : shots) def.stills_s.push_back(shot.time_s);
    options.gl.apply_to(def);
    const Film film(scene, def);
    report_plan(console, film);
    console.detail(fmt::format("{}: {}", film.scene().name, describe(film.system())));
    static_cast<void>(film.camera());
    EmptyPictures empty = options.empty;
    if (!options.dry_run) {
        report_gl(console, film.gl());
        write_shots(shots, options, film, empty);
        warn_of_branch(console, film);
    }
    nlohmann::json json = film_json(film);
    json["outputs"] = nlohmann::json::array();
    for (const Shot& shot : shots) {
        if (options.dry_run) console.info(fmt::format("would write {}", shot.path));
        if (!options.dry_run) console.result(shot.path);
        json["outputs"].push_back({{"path", shot.path}, {"time_s", shot.time_s}});
    }
    json["width"] = film.scene().video.width_px;
    json["height"] = film.scene().video.height_px;
    json["empty"] = empty.count;
    console.report(json);
    return empty.report(console, static_cast<std::int64_t>(shots.size()));
}

}  // namespace

void add_still(CLI::App& app, Action& action) {
    auto options = std::make_shared<StillOptions>();
    CLI::App* command = app.add_subcommand("still", "draw frames at exact times as PNG files");
    options->scene.add_to(*command);
    auto* at = command->add_option("--at", options->times_s, "times in seconds, e.g. 0,0.5,1.25")
                   ->delimiter(',')
                   ->type_name("T[,T...]");
    auto* frame = command->add_option("--frame", options->frames, "frames of the video, from 0")
                      ->delimiter(',')
                      ->type_name("K[,K...]");
    at->excludes(frame);
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
        if (options->times_s.empty() && options->frames.empty()) throw CLI::RequiredError("--at or --frame");
        action = [options](const Console& console) { return still(console, *options); };
    });
}

}  // namespace corda::app
