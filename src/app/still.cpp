#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "figure_options.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct Still : RequestedTime {
    std::string path;
};

/// False as well if the path cannot be examined: the write that follows says why.
bool is_directory(const std::string& path) {
    std::error_code none;
    return std::filesystem::is_directory(path, none);
}

/// Whether the output is one picture. A name with an ending is meant as a file; folders have none, or exist,
/// or end with a slash.
bool is_picture(const std::string& output) {
    const std::filesystem::path path(output);
    const bool is_folder = is_directory(output);
    if (is_figure_path(output) && !is_folder) return true;
    if (output != "-" && (!path.has_extension() || is_folder)) return false;
    throw Error(ExitCode::kUsage,
                fmt::format("-o {}: stills are written as .png, .svg or .pdf; give such a name, or a folder "
                            "(ending with / if its name has a dot)",
                            output));
}

/// What a folder calls it: names that sort by time, with one dot, so that no program takes a part of the
/// time for the ending.
std::string name_of(const RequestedTime& shot, const Scene& scene) {
    std::string name = shot.frame ? fmt::format("{}_f{:06}", scene.name, *shot.frame)
                                  : fmt::format("{}_t{:011.6f}", scene.name, shot.time_s);
    std::replace(name.begin(), name.end(), '.', '_');
    return name + ".png";
}

std::vector<Still> list_stills(const std::vector<RequestedTime>& shots, const Scene& scene) {
    std::vector<Still> stills;
    for (const RequestedTime& shot : shots) stills.push_back({shot, name_of(shot, scene)});
    const auto same = std::adjacent_find(stills.begin(), stills.end(),
                                         [](const Still& a, const Still& b) { return a.path == b.path; });
    if (same != stills.end()) {
        throw Error(ExitCode::kUsage,
                    fmt::format("two stills would both be {}; ask for each time once", same->path));
    }
    return stills;
}

void set_paths(const FigureOptions& options, std::vector<Still>& stills) {
    if (is_picture(options.output)) {
        if (stills.size() != 1) {
            throw Error(ExitCode::kUsage,
                        fmt::format("-o {}: is one file for {} stills; give a folder (`corda strobe` and "
                                    "`corda sheet` draw several times in one picture)",
                                    options.output, stills.size()));
        }
        stills.front().path = options.output;
    } else {
        for (Still& still : stills)
            still.path = (std::filesystem::path(options.output) / still.path).string();
        check_folder(options.output);
        if (!options.dry_run) make_folder(options.output);
        if (!is_directory(options.output)) return;
    }
    for (const Still& still : stills) check_output(still.path, options.scene.input(), options.force);
}

/// Draws and writes the stills, and counts the empty ones. If interrupted, the message says how many were
/// written.
void write_each(const std::vector<Still>& stills, const FigureOptions& options, Film& film,
                EmptyPictures& empty) {
    std::size_t written = 0;
    const std::vector<double> stills_s = options.film_times({stills.begin(), stills.end()});
    try {
        for (const Still& still : stills) {
            stop_if_asked();
            const FigureDef def{.times_s = {still.time_s}, .shutter = options.shutter};
            const auto empty_s =
                write_figure(still.path, film, def,
                             options.describe(film.scene(), {still},
                                              {.command = "still", .shutter = options.shutter}, stills_s),
                             {.force = options.force, .on_progress = stopping_if_asked()});
            ++written;
            if (!empty_s.empty() && empty.count++ == 0) empty.first_s = still.time_s;
        }
    } catch (const Error& error) {
        if (written == 0 || error.code() != interruption()) throw;
        throw Error(error.code(), fmt::format("interrupted: {} of {} stills are written, the last of them {}",
                                              written, stills.size(), stills[written - 1].path));
    }
}

ExitCode write_stills(const Console& console, FigureOptions options) {
    options.take_origin(console, "still");
    const Scene scene = options.load(console);
    const std::vector<RequestedTime> shots = options.shots.list(scene);
    std::vector<Still> stills = list_stills(shots, scene);
    set_paths(options, stills);
    Film film = options.film_of(console, scene, shots);
    EmptyPictures empty = options.empty;
    if (!options.dry_run) {
        if (stills.front().path.ends_with(".png")) report_gl(console, film.gl());
        write_each(stills, options, film, empty);
        warn_of_branch(console, film);
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
    auto options = std::make_shared<FigureOptions>();
    CLI::App* command = app.add_subcommand("still", "draw frames at exact times");
    options->add_to(*command, "folder, or a .png, .svg or .pdf file for one still");
    command
        ->add_option("--shutter", options->shutter,
                     "blur the motion as a video of this video.shutter does; stills are sharp otherwise")
        ->check(within(0.0, 1.0));
    command->callback([options, &action] {
        options->require();
        action = [options](const Console& console) { return write_stills(console, *options); };
    });
}

}  // namespace corda::app
