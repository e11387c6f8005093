#include "figure_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

constexpr double kScreenPpi = 96.0;
constexpr double kPrintPpi = 300.0;

}  // namespace

void FigureOptions::add_to(CLI::App& command, const std::string& output_help) {
    scene.add_to(command);
    scene.add_from(command);
    shots.add_to(command);
    command.add_option("-o,--output", output, output_help)->required();
    scene.add_size(command);
    scene.add_shortcut(command, "--fps", "video.fps", "frames per second");
    scene.add_shortcut(command, "--duration", "world.duration", "seconds");
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
    if (!scene.is_from()) shots.require();
}

void FigureOptions::take_origin(const Console& console, std::string_view command) {
    if (!scene.is_from() || !shots.times_s.empty() || !shots.frames.empty()) return;
    const std::optional<PictureOrigin>& picture = scene.provenance(console).picture;
    if (!picture) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' does not tell which moment it shows; give --at or --frame", scene.input()));
    }
    const bool is_frame = picture->command == "frame" && command == "still";
    if (picture->command != command && !is_frame) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' was made by `corda {}`; use that, or give --at or --frame",
                                scene.input(), picture->command == "frame" ? "render" : picture->command));
    }
    for (const PictureTime& time : picture->times) {
        if (time.frame)
            shots.frames.push_back(std::to_string(*time.frame));
        else
            shots.times_s.push_back(time.time_s);
    }
    film_times_of_origin = picture->film_times_s;
    columns_of_origin = picture->columns;
    if (shutter == 0.0) shutter = is_frame ? load(console).video.shutter : picture->shutter;
    if (!pixels_per_inch && !width_mm) pixels_per_inch = picture->pixels_per_inch;
}

Scene FigureOptions::load(const Console& console) const {
    Scene loaded = scene.load(console);
    if (!width_mm) return loaded;
    VideoDef& video = loaded.video;
    const double width_px = std::round(*width_mm / kMmPerInch * pixels_per_inch.value_or(kPrintPpi));
    const double height_px = std::round(width_px * video.height_px / video.width_px);
    const bool is_sane = std::max(width_px, height_px) <= kMaxSidePx;
    if (!is_sane || !is_picture_size(std::lround(width_px), std::lround(height_px))) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("--width-mm {} at {} pixels per inch is {}x{} pixels, not 1 .. {} per side and "
                        "{} in all; choose another width or --ppi",
                        *width_mm, pixels_per_inch.value_or(kPrintPpi), width_px, height_px, kMaxSidePx,
                        kMaxPicturePx));
    }
    video.width_px = static_cast<int>(width_px);
    video.height_px = static_cast<int>(height_px);
    return loaded;
}

Film FigureOptions::film_of(const Console& console, const Scene& loaded,
                            const std::vector<RequestedTime>& some) const {
    FilmDef def;
    def.on_progress = show_progress(console, "simulate");
    for (const RequestedTime& shot : some) def.stills_s.push_back(shot.time_s);
    for (const double time_s : film_times_of_origin)
        if (time_s <= loaded.world.duration_s) def.stills_s.push_back(time_s);
    gl.apply_to(def);
    Film film(loaded, def);
    report_plan(console, film);
    console.detail(fmt::format("{}: {}", film.scene().name, system_text(film.system())));
    static_cast<void>(film.camera());
    return film;
}

std::vector<double> FigureOptions::film_times(const std::vector<RequestedTime>& some) const {
    std::vector<double> times_s = film_times_of_origin;
    for (const RequestedTime& shot : some)
        if (!shot.frame) times_s.push_back(shot.time_s);
    std::sort(times_s.begin(), times_s.end());
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
    return times_s;
}

PngInfo FigureOptions::describe(const Scene& loaded, const std::vector<RequestedTime>& some,
                                PictureOrigin origin, const std::vector<double>& all_s) const {
    std::string times;
    std::string frames;
    for (const RequestedTime& shot : some) {
        times += fmt::format("{}{}", times.empty() ? "" : ", ", shot.time_s);
        if (shot.frame) frames += fmt::format("{}{}", frames.empty() ? "" : ", ", *shot.frame);
    }
    const double ppi =
        width_mm ? loaded.video.width_px * kMmPerInch / *width_mm : pixels_per_inch.value_or(kScreenPpi);
    for (const RequestedTime& shot : some)
        origin.times.push_back({shot.frame, shot.frame ? 0.0 : shot.time_s});
    const bool are_its_own = std::all_of(all_s.begin(), all_s.end(), [&](double time_s) {
        return std::any_of(origin.times.begin(), origin.times.end(),
                           [&](const PictureTime& its) { return !its.frame && its.time_s == time_s; });
    });
    if (!are_its_own) origin.film_times_s = all_s;
    if (ppi != kScreenPpi) origin.pixels_per_inch = ppi;
    if (!made_) made_ = provenance_of(loaded);
    Provenance made = *made_;
    // A still of a frame has the bytes of the frame, which tells its number elsewhere.
    const bool is_frame = origin.command == "still" && origin.times.front().frame &&
                          origin.shutter == loaded.video.shutter && origin.film_times_s.empty() &&
                          !origin.pixels_per_inch;
    if (!is_frame) made.picture = std::move(origin);
    PngInfo info = picture_info(loaded.name, times, frames, provenance_text(std::move(made)));
    info.pixels_per_inch = ppi;
    return info;
}

ExitCode FigureOptions::write_one(const Console& console, const Scene& loaded,
                                  const std::vector<RequestedTime>& some, const FigureDef& def) const {
    if (!is_figure_path(output)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("-o {}: is one picture, .png, .svg or .pdf; give such a name", output));
    }
    check_output(output, scene.input(), force);
    const bool is_sheet = def.columns > 0;
    const int width_px = is_sheet ? def.width_px : loaded.video.width_px;
    const int height_px = is_sheet ? def.height_px : loaded.video.height_px;
    Scene whole = loaded;
    whole.video.width_px = width_px;
    whole.video.height_px = height_px;
    const PictureOrigin origin{.command = is_sheet ? "sheet" : "strobe", .columns = def.columns};
    Film film = film_of(console, loaded, some);
    EmptyPictures empties = empty;
    if (!dry_run) {
        if (output.ends_with(".png")) report_gl(console, film.gl());
        const auto empty_s = write_figure(output, film, def, describe(whole, some, origin, film_times(some)),
                                          {.force = force, .on_progress = stopping_if_asked()});
        empties.count = static_cast<std::int64_t>(empty_s.size());
        if (!empty_s.empty()) empties.first_s = empty_s.front();
        warn_of_branch(console, film);
        console.result(output);
    } else {
        console.info(fmt::format("would write {}", output));
    }
    nlohmann::json json = film_json(film);
    json["outputs"] = {{{"path", output}, {"times_s", def.times_s}}};
    json["width"] = width_px;
    json["height"] = height_px;
    json["empty"] = empties.count;
    console.report(json);
    return empties.report(console, is_sheet ? static_cast<std::int64_t>(some.size()) : 1);
}

}  // namespace corda::app
