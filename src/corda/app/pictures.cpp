// `corda still`, `strobe` and `sheet`: pictures of a scene.

#include <algorithm>
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
#include "corda/core/timeline.hpp"
#include "corda/film/film.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/print.hpp"
#include "corda/view/overlay.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

/// Options of `still`, `strobe` and `sheet`.
struct PictureOptions {
    SceneOptions scene;
    FilmDef film;
    std::vector<std::string> at;
    std::vector<double> times_s;  ///< those of `at`, once they are read
    std::vector<std::string> frames;
    std::string output;
    std::optional<double> width_mm;
    std::optional<double> pixels_per_inch;
    std::optional<double> font_pt;
    double shutter = 0.0;
    int columns = 0;  ///< 0: what fills the picture best
    bool fail_empty = false;
    bool force = false;
    bool dry_run = false;

    /// Throws CLI::RequiredError if there is no scene, or no moment that is not that of `--from`.
    void require() {
        scene.require();
        for (const std::string& word : at) times_s.push_back(time_of(word));
        if (scene.from.empty() && times_s.empty() && frames.empty())
            throw CLI::RequiredError("--at or --frame");
    }

    /// The time of a word of `--at`. Throws corda::Error (kUsage) for one that is no number.
    static double time_of(const std::string& word) {
        double time_s = 0.0;
        if (CLI::detail::lexical_cast(word, time_s)) return time_s;
        if (word.find(':') != std::string::npos)
            throw_usage(
                "--at {}: is no time in s; list times such as 0,0.25,0.5, or take frames, as in --frame 0:30",
                word);
        throw_usage("--at {}: is no time in s; give one or more, such as 0,0.5,1.25", word);
    }
};

/// A moment of the motion that is to be drawn.
struct RequestedTime {
    double time_s = 0.0;
    std::optional<std::int64_t> frame;  ///< if it was asked for by its number
};

/// A picture to draw for the command `command`.
struct Request {
    std::string command;
    PictureOptions options;            ///< with those of the file of `--from` that were left out
    Scene scene;                       ///< in the size of the picture
    std::vector<RequestedTime> times;  ///< in the order of time
    std::vector<double> film_times_s;  ///< others of the file of `--from`, to which the camera is fitted
    double pixels_per_inch = film::kScreenPpi;
};

struct Picture {
    std::string path;
    std::vector<RequestedTime> times;
};

/// So many pictures are a video.
constexpr std::int64_t kMaxTimes = 100'000;

/// The frames that a word of `--frame` names.
RequestedFrames frames_of(const std::string& word, const Scene& scene) {
    const std::int64_t count = scene.video.scene_rate().frame_count(scene.world.duration_s);
    RequestedFrames range;
    if (const auto frame = whole_number<std::int64_t>(word)) {
        range = {*frame, *frame + (*frame < count ? 1 : 0)};
    } else if (const auto parsed = parse_frames(word)) {
        range = *parsed;
    } else {
        const bool has_step = std::ranges::count(word, ':') > 1;
        throw_usage("--frame {}: is neither a frame number nor a range FIRST:END of them{}", word,
                    has_step ? "; a range has no step: list frames such as 0,24,48" : "");
    }
    const std::int64_t end = range.end.value_or(count);
    if (range.first < 0 || range.first >= end || end > count) {
        throw_usage(
            "--frame {}: the frames are 0 to {}, all of them the range 0:{}; world.duration sets the end",
            word, count - 1, count);
    }
    return {range.first, end};
}

/// The moments of `--at` and `--frame`. Throws corda::Error (kUsage) for one that the scene does not have.
std::vector<RequestedTime> requested_times(const PictureOptions& options, const Scene& scene) {
    std::vector<RequestedTime> times;
    for (const double time_s : options.times_s) {
        const auto within_s = time_within(time_s, scene.world.duration_s);
        if (!within_s) {
            throw_usage("--at {}: is not within 0 .. {} s; world.duration sets the end", time_s,
                        scene.world.duration_s);
        }
        times.push_back({*within_s, std::nullopt});
    }
    for (const std::string& word : options.frames) {
        const RequestedFrames range = frames_of(word, scene);
        const auto count = static_cast<std::int64_t>(times.size()) + *range.end - range.first;
        if (count > kMaxTimes) {
            throw_usage(
                "--frame {}: are {} pictures or more, over the limit of {}; `corda render` makes a video of "
                "them",
                word, count, kMaxTimes);
        }
        for (std::int64_t k = range.first; k < *range.end; ++k)
            times.push_back({scene.video.scene_rate().time_s(k), k});
    }
    std::ranges::stable_sort(times, {}, &RequestedTime::time_s);
    return times;
}

/// Takes the options that the command line leaves out from the file of `--from`.
void take_record(const std::optional<PictureOrigin>& record, Request& request) {
    auto& [command, options, scene, times, film_times_s, ppi] = request;
    if (options.scene.from.empty() || !options.times_s.empty() || !options.frames.empty()) return;
    if (!record) throw_usage("'{}' has no record of its time; give --at or --frame", options.scene.from);
    const bool is_frame = record->command == "frame" && command == "still";
    if (record->command != command && !is_frame) {
        throw_usage("'{}' was made by `corda {}`; use that, or give --at or --frame", options.scene.from,
                    record->command == "frame" ? "render" : record->command);
    }
    for (const PictureTime& time : record->times) {
        if (time.frame)
            options.frames.push_back(std::to_string(*time.frame));
        else
            options.times_s.push_back(time.time_s);
    }
    film_times_s = record->film_times_s;
    if (options.columns == 0) options.columns = record->columns;
    if (options.shutter == 0.0) options.shutter = is_frame ? scene.video.shutter : record->shutter;
    if (options.width_mm) return;
    if (!options.pixels_per_inch) options.pixels_per_inch = record->pixels_per_inch;
    const auto gives_letters = [](const Setting& setting) {
        return setting.starts_with("overlay.text_px") || setting.starts_with("overlay=");
    };
    if (!options.font_pt && std::ranges::none_of(options.scene.settings, gives_letters))
        options.font_pt = record->font_pt;
}

/// Gives the scene the size and the letters of a picture in print.
void set_print(Request& request) {
    auto& [command, options, scene, times, film_times_s, ppi] = request;
    const film::Print print =
        film::print_of(scene, {options.width_mm, options.pixels_per_inch, options.font_pt},
                       {"--width-mm", "--ppi", "--font-pt"});
    if (options.width_mm) set_size(scene, print.width_px, print.height_px);
    ppi = print.pixels_per_inch;
    options.font_pt = print.letter_pt;
    if (scene.overlay.text_px == print.text_px) return;
    scene.overlay.text_px = print.text_px;
    scene.settings.push_back(fmt::format("overlay.text_px={}", *print.text_px));
}

Request request_of(const Console& console, const PictureOptions& options, const char* command) {
    Loaded loaded = load(console, options.scene);
    Request request{command, options, std::move(loaded.scene), {}, {}};
    take_record(loaded.origin.picture, request);
    set_print(request);
    request.times = requested_times(request.options, request.scene);
    return request;
}

std::vector<double> times_of(const std::vector<RequestedTime>& some) {
    std::vector<double> times_s;
    for (const RequestedTime& time : some) times_s.push_back(time.time_s);
    return times_s;
}

/// The times of a request that are no frames, and those of the file of `--from`.
std::vector<double> times_between_frames(const Request& request) {
    std::vector<double> times_s = request.film_times_s;
    for (const RequestedTime& time : request.times)
        if (!time.frame) times_s.push_back(time.time_s);
    std::ranges::sort(times_s);
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
    return times_s;
}

/// The text chunks and the resolution of a picture of `made`.
PngInfo png_info(const Request& request, const Picture& picture, PictureOrigin origin, Provenance made) {
    const auto& [command, options, scene, times, film_times_s, ppi] = request;
    std::string times_text;
    std::string frames;
    for (const RequestedTime& time : picture.times) {
        times_text += fmt::format("{}{}", times_text.empty() ? "" : ", ", time.time_s);
        if (time.frame) frames += fmt::format("{}{}", frames.empty() ? "" : ", ", *time.frame);
        origin.times.push_back({time.frame, time.frame ? 0.0 : time.time_s});
    }
    const std::vector<double> all_s = times_between_frames(request);
    const bool are_origins = std::ranges::all_of(all_s, [&](double time_s) {
        return std::ranges::any_of(
            origin.times, [&](const PictureTime& time) { return !time.frame && time.time_s == time_s; });
    });
    if (!are_origins) origin.film_times_s = all_s;
    origin.font_pt = options.font_pt;
    if (ppi != film::kScreenPpi) origin.pixels_per_inch = ppi;
    // A still of a frame has the bytes of the frame, whose number is elsewhere in the record.
    const bool is_frame = command == "still" && origin.times.front().frame &&
                          options.shutter == scene.video.shutter && origin.film_times_s.empty() &&
                          !origin.pixels_per_inch && !origin.font_pt;
    if (!is_frame) made.picture = std::move(origin);
    PngInfo info = picture_info(scene.name, times_text, frames, provenance_text(std::move(made)));
    info.pixels_per_inch = ppi;
    return info;
}

/// Draws and writes the pictures; returns the times of empty ones. If interrupted, the message says how many
/// were written.
std::vector<double> write_pictures(const Request& request, const std::vector<Picture>& pictures,
                                   const Film& film, FigureDef def) {
    const PictureOrigin origin{.command = request.command, .columns = def.columns, .shutter = def.shutter};
    const Provenance made = provenance_of(request.scene);
    std::size_t written = 0;
    std::vector<double> empty_s;
    try {
        for (const Picture& picture : pictures) {
            check_cancelled();
            def.times_s = times_of(picture.times);
            const auto empty = write_figure(picture.path, film, def, png_info(request, picture, origin, made),
                                            {.force = request.options.force});
            empty_s.insert(empty_s.end(), empty.begin(), empty.end());
            ++written;
        }
    } catch (const Error& error) {
        if (written == 0 || error.code() != interruption()) throw;
        throw_error(error.code(), "interrupted: {} of {} stills are written, the last of them {}", written,
                    pictures.size(), pictures[written - 1].path);
    }
    return empty_s;
}

/// Makes the pictures of a command, and reports them. `cell`: the scene in the size of a cell of a sheet,
/// otherwise the scene of the request.
ExitCode draw(const Console& console, const Request& request, const Scene& cell, const FigureDef& def,
              const std::vector<Picture>& pictures) {
    const auto& [command, options, scene, times, film_times_s, ppi] = request;
    FilmDef film_def = options.film;
    film_def.stills_s = times_of(times);
    film_def.stills_shutter = def.shutter;
    for (const double time_s : film_times_s)
        if (time_s <= scene.world.duration_s) film_def.stills_s.push_back(time_s);
    const Film film = make_film(console, cell, film_def, "simulate");
    console.detail(fmt::format("{}: {}", scene.name, system_text(film.system())));
    warn_of_room(console, film);
    std::vector<double> empty_s;
    if (!options.dry_run) {
        if (pictures.front().path.ends_with(".png")) report_gl(console, film.gl());
        empty_s = write_pictures(request, pictures, film, def);
        warn_of_branch(console, film);
    }
    nlohmann::json json = film_json(film);
    for (const Picture& picture : pictures) {
        if (options.dry_run)
            console.info(fmt::format("would write {}", picture.path));
        else
            console.result(picture.path);
        nlohmann::json output = {{"path", picture.path}};
        if (command == "still")
            output["time_s"] = picture.times.front().time_s;
        else
            output["times_s"] = times_of(picture.times);
        json["outputs"].push_back(std::move(output));
    }
    json["width"] = scene.video.width_px;
    json["height"] = scene.video.height_px;
    json["empty"] = empty_s.size();
    console.report(json);
    const std::int64_t all = command == "sheet" ? std::ssize(times) : std::ssize(pictures);
    return report_empty(console, {std::ssize(empty_s), all, empty_s.empty() ? 0.0 : empty_s.front()},
                        options.fail_empty, scene.camera);
}

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

/// The names of stills in a folder, "swing_0.5s.png", which sort by time.
std::vector<Picture> named(const std::vector<RequestedTime>& times, std::string scene) {
    std::ranges::replace(scene, '.', '_');
    std::vector<std::string> digits = view::digits_of(times_of(times));
    std::size_t longest = 0;
    for (const std::string& text : digits) longest = std::max(longest, text.size());
    std::vector<Picture> stills;
    for (std::size_t i = 0; i < times.size(); ++i) {
        digits[i].insert(0, longest - digits[i].size(), '0');
        stills.push_back({times[i].frame ? fmt::format("{}_f{:06}.png", scene, *times[i].frame)
                                         : fmt::format("{}_{}s.png", scene, digits[i]),
                          {times[i]}});
    }
    return stills;
}

std::vector<Picture> stills_of(const Request& request) {
    const PictureOptions& options = request.options;
    std::vector<Picture> stills = named(request.times, request.scene.name);
    const auto same = std::ranges::adjacent_find(stills, {}, &Picture::path);
    if (same != stills.end()) throw_usage("two stills would both be {}; ask for each time once", same->path);
    if (is_picture(options.output)) {
        if (stills.size() != 1) {
            throw_usage(
                "-o {}: is one file for {} stills; give a folder (`corda strobe` and `corda sheet` draw "
                "several times in one picture)",
                options.output, stills.size());
        }
        stills.front().path = options.output;
    } else {
        for (Picture& still : stills)
            still.path = (std::filesystem::path(options.output) / still.path).string();
        check_folder(options.output);
        if (!options.dry_run) make_folder(options.output);
        if (!is_directory(options.output)) return stills;
    }
    for (const Picture& still : stills) check_output(still.path, options.scene.input(), options.force);
    return stills;
}

/// The only picture of a request.
std::vector<Picture> picture_of(const Request& request) {
    const PictureOptions& options = request.options;
    if (!is_figure_path(options.output))
        throw_usage("-o {}: is one picture, .png, .svg or .pdf; give such a name", options.output);
    check_output(options.output, options.scene.input(), options.force);
    return {{options.output, request.times}};
}

ExitCode draw_stills(const Console& console, const PictureOptions& options) {
    const Request request = request_of(console, options, "still");
    return draw(console, request, request.scene, {.times_s = {}, .shutter = request.options.shutter},
                stills_of(request));
}

ExitCode draw_strobe(const Console& console, const PictureOptions& options) {
    Request request = request_of(console, options, "strobe");
    const auto is_same = [](const RequestedTime& a, const RequestedTime& b) { return a.time_s == b.time_s; };
    request.times.erase(std::unique(request.times.begin(), request.times.end(), is_same),
                        request.times.end());
    return draw(console, request, request.scene, {}, picture_of(request));
}

ExitCode draw_sheet(const Console& console, const PictureOptions& options) {
    const Request request = request_of(console, options, "sheet");
    Scene cell = request.scene;
    const auto text_px = request.options.font_pt ? request.scene.overlay.text_px : std::nullopt;
    const FigureDef def = contact_sheet(cell, times_of(request.times), request.options.columns, text_px);
    return draw(console, request, cell, def, picture_of(request));
}

/// Adds the options of all three; `output_help` says what the output may be.
void add_options(CLI::App& command, PictureOptions& options, const std::string& output_help) {
    add_scene(command, options.scene);
    add_from(command, options.scene);
    add_positions(command, options.scene);
    auto* at = command.add_option("--at", options.at, "times in seconds, e.g. 0,0.5,1.25")
                   ->delimiter(',')
                   ->allow_extra_args(false)  // the scene may follow
                   ->type_name("T[,T...]");
    auto* frame =
        command
            .add_option("--frame", options.frames, "frames of the video from 0, or ranges FIRST <= k < END")
            ->delimiter(',')
            ->allow_extra_args(false)
            ->type_name("K|FIRST:END[,...]");
    at->excludes(frame);
    command.add_option("-o,--output", options.output, output_help)->required();
    add_size(command, options.scene);
    add_timing(command, options.scene);
    command.add_option("--width-mm", options.width_mm, "width in print; the height follows from video.size")
        ->check(within(1.0, 10000.0))
        ->excludes("--size");
    command
        .add_option("--ppi", options.pixels_per_inch,
                    "pixels per inch in print; 96, or 300 with --width-mm, whose pixels it sets")
        ->check(within(1.0, 10000.0));
    command.add_option("--font-pt", options.font_pt, "size of letters in points; 8 with --width-mm")
        ->check(within(1.0, 100.0));
    add_gl(command, options.film);
    add_fail_empty(command, options.fail_empty);
    command.add_flag("--force", options.force, "replace existing files");
    command.add_flag("--dry-run", options.dry_run, "check everything but OpenGL, and write nothing");
}

}  // namespace

void add_still(CLI::App& app, Action& action) {
    auto [command, options] = add_command(app, action, "still", "draw frames at exact times", draw_stills);
    add_options(command, options, "folder, or a .png, .svg or .pdf file for one still");
    command
        .add_option("--shutter", options.shutter,
                    "blur the motion as a video of this video.shutter does; stills are sharp otherwise")
        ->check(within(0.0, 1.0));
}

void add_strobe(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "strobe", "draw several poses in one picture, earlier ones fainter", draw_strobe);
    add_options(command, options, "picture: .png, .svg or .pdf");
}

void add_sheet(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "sheet", "draw a contact sheet: a picture of cells, one per time", draw_sheet);
    add_options(command, options,
                "picture: .png, .svg or .pdf; --size and --width-mm are those of all of it");
    command
        .add_option("--columns", options.columns, "cells side by side; default: what fills the picture best")
        ->check(within(1.0, 1000.0));
}

}  // namespace corda::app
