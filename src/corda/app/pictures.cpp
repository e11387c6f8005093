// `corda still`, `strobe` and `sheet`: pictures of a scene.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/film/plan_text.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

constexpr double kScreenPpi = 96.0;
constexpr double kPrintPpi = 300.0;

/// Options that `still`, `strobe` and `sheet` share.
struct FigureOptions {
    SceneOptions scene;
    GlOptions gl;
    EmptyPictures empty;
    TimeOptions times;
    std::string output;
    std::optional<double> width_mm;
    std::optional<double> pixels_per_inch;
    double shutter = 0.0;
    bool force = false;
    bool dry_run = false;
    // Of the file of `--from`.
    std::vector<double> film_times_of_origin;
    int columns_of_origin = 0;
    bool blurs_as_video = false;  ///< it is a frame

    /// `output_help` says what the output may be.
    void add_to(CLI::App& command, const std::string& output_help);
    /// The scene with the picture size that `--width-mm` asks for.
    [[nodiscard]] Scene load(const Console& console) const;
    [[nodiscard]] double shutter_of(const Scene& one) const {
        return blurs_as_video ? one.video.shutter : shutter;
    }
    /// Throws CLI::RequiredError if there is no scene, or no moment that is not that of `--from`.
    void require() const;
    /// Takes the options that the command line does not give from the file of `--from`, made by `command`.
    void take_origin(const Console& console, std::string_view command);
    /// The times that the film records in addition to those of frames.
    [[nodiscard]] std::vector<double> film_times(const std::vector<RequestedTime>& some) const;
    [[nodiscard]] Film film_of(const Console& console, const Scene& one,
                               const std::vector<RequestedTime>& some) const;
    /// The text chunks and the resolution of the file of a figure. `one` has the size of the picture;
    /// `origin` gets its times, of which the film also has `all_s`.
    [[nodiscard]] PngInfo png_info(const Scene& one, const std::vector<RequestedTime>& some,
                                   PictureOrigin origin, const std::vector<double>& all_s) const;
    /// Makes the only picture of a command, and reports it. `cell`: the scene in the size of a cell of a
    /// sheet, else `one`.
    ExitCode write_one(const Console& console, const Scene& one, const Scene& cell,
                       const std::vector<RequestedTime>& some, const FigureDef& def) const;

  private:
    mutable std::optional<Provenance> made_;  ///< of the scene that png_info() is given
};

void FigureOptions::add_to(CLI::App& command, const std::string& output_help) {
    scene.add_to(command);
    scene.add_from(command);
    times.add_to(command);
    command.add_option("-o,--output", output, output_help)->required();
    scene.add_size(command);
    scene.add_timing(command);
    command.add_option("--width-mm", width_mm, "width in print; the height follows from video.size")
        ->check(within(1.0, 10000.0))
        ->excludes("--size");
    command
        .add_option("--ppi", pixels_per_inch,
                    "pixels per inch in print; 96, or 300 with --width-mm, whose pixels it sets")
        ->check(within(1.0, 10000.0));
    gl.add_to(command);
    empty.add_to(command);
    command.add_flag("--force", force, "replace existing files");
    command.add_flag("--dry-run", dry_run, "check everything but OpenGL, and write nothing");
}

void FigureOptions::require() const {
    scene.require();
    if (!scene.is_from()) times.require();
}

void FigureOptions::take_origin(const Console& console, std::string_view command) {
    if (!scene.is_from() || !times.times_s.empty() || !times.frames.empty()) return;
    const std::optional<PictureOrigin>& picture = scene.provenance(console).picture;
    if (!picture) throw_usage("'{}' has no record of its time; give --at or --frame", scene.input());
    const bool is_frame = picture->command == "frame" && command == "still";
    if (picture->command != command && !is_frame) {
        throw_usage("'{}' was made by `corda {}`; use that, or give --at or --frame", scene.input(),
                    picture->command == "frame" ? "render" : picture->command);
    }
    for (const PictureTime& time : picture->times) {
        if (time.frame)
            times.frames.push_back(std::to_string(*time.frame));
        else
            times.times_s.push_back(time.time_s);
    }
    film_times_of_origin = picture->film_times_s;
    columns_of_origin = picture->columns;
    blurs_as_video = is_frame && shutter == 0.0;
    if (shutter == 0.0) shutter = picture->shutter;
    if (!pixels_per_inch && !width_mm) pixels_per_inch = picture->pixels_per_inch;
}

Scene FigureOptions::load(const Console& console) const {
    Scene one = scene.load(console);
    if (!width_mm) return one;
    const VideoDef& video = one.video;
    const double width_px = std::round(*width_mm / kMmPerInch * pixels_per_inch.value_or(kPrintPpi));
    const double height_px = std::round(width_px * video.height_px / video.width_px);
    const bool is_sane = std::max(width_px, height_px) <= kMaxSidePx;
    if (!is_sane || !is_picture_size(std::lround(width_px), std::lround(height_px))) {
        throw_usage(
            "--width-mm {} at {} pixels per inch is {}x{} pixels, not 1 .. {} per side and {} in all; "
            "choose another width or --ppi",
            *width_mm, pixels_per_inch.value_or(kPrintPpi), width_px, height_px, kMaxSidePx, kMaxPicturePx);
    }
    set_size(one, static_cast<int>(width_px), static_cast<int>(height_px));
    return one;
}

std::vector<double> times_of(const std::vector<RequestedTime>& some) {
    std::vector<double> times_s;
    for (const RequestedTime& time : some) times_s.push_back(time.time_s);
    return times_s;
}

Film FigureOptions::film_of(const Console& console, const Scene& one,
                            const std::vector<RequestedTime>& some) const {
    FilmDef def;
    def.on_progress = show_progress(console, "simulate");
    def.stills_s = times_of(some);
    def.stills_shutter = shutter_of(one);
    for (const double time_s : film_times_of_origin)
        if (time_s <= one.world.duration_s) def.stills_s.push_back(time_s);
    gl.apply_to(def);
    Film film(one, def);
    report_plan(console, film);
    console.detail(fmt::format("{}: {}", film.scene().name, system_text(film.system())));
    warn_of_room(console, film);
    return film;
}

std::vector<double> FigureOptions::film_times(const std::vector<RequestedTime>& some) const {
    std::vector<double> times_s = film_times_of_origin;
    for (const RequestedTime& time : some)
        if (!time.frame) times_s.push_back(time.time_s);
    std::ranges::sort(times_s);
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
    return times_s;
}

PngInfo FigureOptions::png_info(const Scene& one, const std::vector<RequestedTime>& some,
                                PictureOrigin origin, const std::vector<double>& all_s) const {
    std::string times_text;
    std::string frames;
    for (const RequestedTime& time : some) {
        times_text += fmt::format("{}{}", times_text.empty() ? "" : ", ", time.time_s);
        if (time.frame) frames += fmt::format("{}{}", frames.empty() ? "" : ", ", *time.frame);
    }
    const double ppi =
        width_mm ? one.video.width_px * kMmPerInch / *width_mm : pixels_per_inch.value_or(kScreenPpi);
    for (const RequestedTime& time : some)
        origin.times.push_back({time.frame, time.frame ? 0.0 : time.time_s});
    const bool are_origins = std::ranges::all_of(all_s, [&](double time_s) {
        return std::ranges::any_of(
            origin.times, [&](const PictureTime& time) { return !time.frame && time.time_s == time_s; });
    });
    if (!are_origins) origin.film_times_s = all_s;
    if (ppi != kScreenPpi) origin.pixels_per_inch = ppi;
    if (!made_) made_ = provenance_of(one);
    Provenance made = *made_;
    // A still of a frame has the bytes of the frame, whose number is elsewhere in the record.
    const bool is_frame = origin.command == "still" && origin.times.front().frame &&
                          shutter_of(one) == one.video.shutter && origin.film_times_s.empty() &&
                          !origin.pixels_per_inch;
    if (!is_frame) made.picture = std::move(origin);
    PngInfo info = picture_info(one.name, times_text, frames, provenance_text(std::move(made)));
    info.pixels_per_inch = ppi;
    return info;
}

ExitCode FigureOptions::write_one(const Console& console, const Scene& one, const Scene& cell,
                                  const std::vector<RequestedTime>& some, const FigureDef& def) const {
    if (!is_figure_path(output))
        throw_usage("-o {}: is one picture, .png, .svg or .pdf; give such a name", output);
    check_output(output, scene.input(), force);
    const bool is_sheet = def.columns > 0;
    const PictureOrigin origin{.command = is_sheet ? "sheet" : "strobe", .columns = def.columns};
    Film film = film_of(console, cell, some);
    EmptyPictures empties = empty;
    if (!dry_run) {
        if (output.ends_with(".png")) report_gl(console, film.gl());
        const auto empty_s =
            write_figure(output, film, def, png_info(one, some, origin, film_times(some)), {.force = force});
        empties.count = std::ssize(empty_s);
        if (!empty_s.empty()) empties.first_s = empty_s.front();
        warn_of_branch(console, film);
        console.result(output);
    } else {
        console.info(fmt::format("would write {}", output));
    }
    nlohmann::json json = film_json(film);
    json["outputs"] = {{{"path", output}, {"times_s", times_of(some)}}};
    json["width"] = one.video.width_px;
    json["height"] = one.video.height_px;
    json["empty"] = empties.count;
    console.report(json);
    return empties.report(console, is_sheet ? std::ssize(some) : 1, one.camera);
}

struct Still : RequestedTime {
    std::string path;
};

/// False as well if the path cannot be examined: the write that follows says why.
bool is_directory(const std::string& path) {
    std::error_code none;
    return std::filesystem::is_directory(path, none);
}

/// Whether the output is one picture. A name with an ending is that of a file; folders have none, or exist,
/// or end with a slash.
bool is_picture(const std::string& output) {
    const std::filesystem::path path(output);
    const bool is_folder = is_directory(output);
    if (is_figure_path(output) && !is_folder) return true;
    if (output != "-" && (!path.has_extension() || is_folder)) return false;
    throw_usage(
        "-o {}: stills are written as .png, .svg or .pdf; give such a name, or a folder (ending with / if "
        "its name has a dot)",
        output);
}

/// Its name in a folder: names sort by time and have one dot, so that no program takes a part of the time for
/// the ending.
std::string name_of(const RequestedTime& time, const std::string& scene) {
    std::string name = time.frame ? fmt::format("{}_f{:06}", scene, *time.frame)
                                  : fmt::format("{}_t{:011.6f}", scene, time.time_s);
    std::ranges::replace(name, '.', '_');
    return name + ".png";
}

std::vector<Still> list_stills(const std::vector<RequestedTime>& times, const Scene& scene) {
    std::vector<Still> stills;
    for (const RequestedTime& time : times) stills.push_back({time, name_of(time, scene.name)});
    const auto same = std::ranges::adjacent_find(stills, {}, &Still::path);
    if (same != stills.end()) throw_usage("two stills would both be {}; ask for each time once", same->path);
    return stills;
}

void set_paths(const FigureOptions& options, std::vector<Still>& stills) {
    if (is_picture(options.output)) {
        if (stills.size() != 1) {
            throw_usage(
                "-o {}: is one file for {} stills; give a folder (`corda strobe` and `corda sheet` draw "
                "several times in one picture)",
                options.output, stills.size());
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
void write_each(const std::vector<Still>& stills, const FigureOptions& options, const Film& film,
                EmptyPictures& empty) {
    std::size_t written = 0;
    const Scene& scene = film.scene();
    const std::vector<double> stills_s = options.film_times({stills.begin(), stills.end()});
    const PictureOrigin origin{.command = "still", .shutter = options.shutter_of(scene)};
    try {
        for (const Still& still : stills) {
            check_cancelled();
            const auto empty_s =
                write_figure(still.path, film, {.times_s = {still.time_s}, .shutter = origin.shutter},
                             options.png_info(scene, {still}, origin, stills_s), {.force = options.force});
            ++written;
            if (!empty_s.empty() && empty.count++ == 0) empty.first_s = still.time_s;
        }
    } catch (const Error& error) {
        if (written == 0 || error.code() != interruption()) throw;
        throw_error(error.code(), "interrupted: {} of {} stills are written, the last of them {}", written,
                    stills.size(), stills[written - 1].path);
    }
}

ExitCode write_stills(const Console& console, FigureOptions options) {
    options.take_origin(console, "still");
    const Scene scene = options.load(console);
    const std::vector<RequestedTime> times = options.times.list(scene);
    std::vector<Still> stills = list_stills(times, scene);
    set_paths(options, stills);
    Film film = options.film_of(console, scene, times);
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
    json["width"] = scene.video.width_px;
    json["height"] = scene.video.height_px;
    json["empty"] = empty.count;
    console.report(json);
    return empty.report(console, std::ssize(stills), scene.camera);
}

ExitCode write_strobe(const Console& console, FigureOptions options) {
    options.take_origin(console, "strobe");
    const Scene scene = options.load(console);
    std::vector<RequestedTime> times = options.times.list(scene);
    const auto is_same = [](const RequestedTime& a, const RequestedTime& b) { return a.time_s == b.time_s; };
    times.erase(std::unique(times.begin(), times.end(), is_same), times.end());
    return options.write_one(console, scene, scene, times, {.times_s = times_of(times)});
}

struct SheetOptions : FigureOptions {
    int columns = 0;
};

ExitCode write_sheet(const Console& console, SheetOptions options) {
    options.take_origin(console, "sheet");
    if (options.columns == 0) options.columns = options.columns_of_origin;
    const Scene scene = options.load(console);
    const std::vector<RequestedTime> times = options.times.list(scene);
    Scene cell = scene;
    const FigureDef def = contact_sheet(cell, times_of(times), options.columns);
    return options.write_one(console, scene, cell, times, def);
}

}  // namespace

void add_still(CLI::App& app, Action& action) {
    auto [command, options] = add_command(app, action, "still", "draw frames at exact times", write_stills);
    options.add_to(command, "folder, or a .png, .svg or .pdf file for one still");
    command
        .add_option("--shutter", options.shutter,
                    "blur the motion as a video of this video.shutter does; stills are sharp otherwise")
        ->check(within(0.0, 1.0));
}

void add_strobe(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "strobe", "draw several poses in one picture, earlier ones fainter", write_strobe);
    options.add_to(command, "picture: .png, .svg or .pdf");
}

void add_sheet(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "sheet", "draw a contact sheet: a picture of cells, one per time", write_sheet);
    options.add_to(command, "picture: .png, .svg or .pdf; --size and --width-mm are those of all of it");
    command
        .add_option("--columns", options.columns, "cells side by side; default: what fills the picture best")
        ->check(within(1.0, 1000.0));
}

}  // namespace corda::app
