#include "figure_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/pipeline/describe.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

constexpr double kScreenPpi = 96.0;
constexpr double kPrintPpi = 300.0;

}  // namespace

void FigureOptions::add_to(CLI::App& command, const std::string& output_help) {
    scene.add_to(command);
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
    command.add_flag("--dry-run", dry_run, "check everything and write nothing");
}

Scene FigureOptions::load() const {
    Scene loaded = scene.load();
    if (!width_mm) return loaded;
    VideoDef& video = loaded.video;
    const double width_px = std::round(*width_mm / kMmPerInch * pixels_per_inch.value_or(kPrintPpi));
    const double height_px = std::round(width_px * video.height_px / video.width_px);
    const bool is_sane = std::max(width_px, height_px) <= kLargestSidePx;
    if (!is_sane || !is_picture_size(std::lround(width_px), std::lround(height_px))) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("--width-mm {} at {} pixels per inch is {}x{} pixels, not 1 .. {} per side and "
                        "{} in all; choose another width or --ppi",
                        *width_mm, pixels_per_inch.value_or(kPrintPpi), width_px, height_px, kLargestSidePx,
                        kMostPicturePx));
    }
    video.width_px = static_cast<int>(width_px);
    video.height_px = static_cast<int>(height_px);
    return loaded;
}

Film FigureOptions::film_of(const Console& console, const Scene& loaded,
                            const std::vector<Shot>& some) const {
    FilmDef def;
    def.on_progress = show_progress(console, "simulate");
    for (const Shot& shot : some) def.stills_s.push_back(shot.time_s);
    gl.apply_to(def);
    Film film(loaded, def);
    report_plan(console, film);
    console.detail(fmt::format("{}: {}", film.scene().name, corda::describe(film.system())));
    static_cast<void>(film.camera());
    return film;
}

PngInfo FigureOptions::describe(const Scene& loaded, const std::vector<Shot>& some, int width_px) const {
    std::string times;
    std::string frames;
    for (const Shot& shot : some) {
        times += fmt::format("{}{}", times.empty() ? "" : ", ", shot.time_s);
        if (shot.frame) frames += fmt::format("{}{}", frames.empty() ? "" : ", ", *shot.frame);
    }
    PngInfo info = picture_info(loaded.name, times, frames);
    info.pixels_per_inch =
        width_mm ? width_px * kMmPerInch / *width_mm : pixels_per_inch.value_or(kScreenPpi);
    return info;
}

ExitCode FigureOptions::write_one(const Console& console, const Scene& loaded, const std::vector<Shot>& some,
                                  const FigureDef& def) const {
    if (!is_figure_path(output)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("-o {}: is one picture, .png, .svg or .pdf; give such a name", output));
    }
    check_output(output, scene.path, force);
    const bool is_sheet = def.columns > 0;
    const int width_px = is_sheet ? def.width_px : loaded.video.width_px;
    const int height_px = is_sheet ? def.height_px : loaded.video.height_px;
    const Film film = film_of(console, loaded, some);
    EmptyPictures empties = empty;
    if (!dry_run) {
        if (output.ends_with(".png")) report_gl(console, film.gl());
        const auto empty_s = write_figure(output, film, def, describe(loaded, some, width_px),
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
