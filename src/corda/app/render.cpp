#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/write/video_file.hpp"
#include "corda/view/colors.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct RenderOptions {
    SceneOptions scene;
    FilmDef film;
    std::string output;
    std::string frames;
    bool fail_empty = false;
    bool pad = false;
    bool force = false;
    bool resume = false;
    bool dry_run = false;

    void require() const { scene.require(); }
};

/// Which frames are drawn, and how their files are written. Without --frames a file is repeated with its own
/// frames, unless the scene gets another number of them.
RenderDef render_def(const RenderOptions& options, const std::string& frames_of_origin) {
    RenderDef def;
    def.force = options.force;
    def.resume = options.resume;
    const auto changes_frames = [](const Setting& setting) {
        return setting.starts_with("world.duration") || setting.starts_with("video.fps") ||
               setting.starts_with("video.speed");
    };
    const bool has_its_frames = std::ranges::none_of(options.scene.settings, changes_frames) &&
                                std::ranges::none_of(options.scene.shortcuts, changes_frames);
    const std::string& frames = options.frames.empty() && has_its_frames ? frames_of_origin : options.frames;
    if (frames.empty()) return def;
    const auto range = parse_frames(frames);
    if (!range) throw_usage("--frames {}: is not FIRST:END, two frame numbers (END is not drawn)", frames);
    def.first = range->first;
    def.end = range->end;
    return def;
}

bool is_one_file(const std::string& output) {
    const media::FileKind kind = media::find_ending(output).kind;
    return kind == media::FileKind::kVideo || kind == media::FileKind::kAnimation;
}

/// Message for an interrupted render: its state, and the way to continue.
std::string words_of_interruption(const RenderOptions& options, std::int64_t count,
                                  const Rendered& rendered) {
    if (is_one_file(options.output) || rendered.frames == 0)
        return fmt::format("interrupted; {} was not written", options.output);
    if (is_standard_output(options.output))
        return fmt::format(
            "interrupted: {} of {} frames are in standard output, perhaps with a part of the next",
            rendered.frames, count);
    return fmt::format("interrupted: {} of {} frames are in {} (--resume draws the others)", rendered.frames,
                       count, options.output);
}

nlohmann::json report(const Film& film, const VideoDef& video, const RenderOptions& options,
                      const Rendered& rendered, double wall_s, const std::string& gl_renderer) {
    nlohmann::json json = film_json(film);
    json["output"] = options.output;
    json["frames"] = rendered.frames;
    json["kept_frames"] = rendered.kept_frames;
    json["width"] = video.width_px;
    json["height"] = video.height_px;
    json["fps"] = video.fps.per_second();
    json["speed"] = video.speed.text();
    json["fps_exact"] = video.fps.rational().text();
    json["wall_s"] = wall_s;
    json["frames_per_wall_s"] = static_cast<double>(rendered.frames) / wall_s;
    json["encoder"] = rendered.encoder;
    json["empty_frames"] = rendered.empty_frames;
    json["gl_renderer"] = gl_renderer;
    return json;
}

/// ".mp4 (H.264, ...)" and so on.
std::string endings_text() {
    std::string text;
    for (const media::Ending& ending : media::endings()) {
        std::set<std::string_view> codecs;
        for (const char* const name : ending.codecs)
            if (name != nullptr) codecs.insert(media::find_codec(name)->standard);
        const bool is_one = ending.kind != media::FileKind::kVideo;
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", ending.text,
                            is_one ? std::string(ending.words) : fmt::format("{}", fmt::join(codecs, ", ")));
    }
    return text;
}

/// Warns if the output format falls back from its default or loses transparency.
void report_format(const Console& console, const Scene& scene, const CheckedOutput& output) {
    const media::Format& format = output.video().format;
    if (format.is_fallback) {
        console.warning(fmt::format("{}, the default of {}, is not available: encoding with {} ({})",
                                    format.ending->codecs.front(), format.ending->text, format.codec->name,
                                    format.codec->standard));
    }
    if (!view::theme_colors(scene.style).ground.is_opaque() &&
        std::string_view(format.ending->muxer) == "gif")
        console.warning(fmt::format(
            "a GIF has no half transparent pixels: edges will be hard{}; .webm and .mov keep them",
            scene.video.shutter > 0.0 ? ", and parts that motion blur makes fainter than half are left out"
                                      : ""));
}

void check_standard_output(const Console& console, const std::string& output) {
    if (!is_standard_output(output)) return;
    if (isatty(STDOUT_FILENO) == 1)
        throw Error(ExitCode::kUsage,
                    "-o -: pixels are not for a terminal; pipe them into a program or a file");
    if (console.json())
        throw Error(ExitCode::kUsage,
                    "-o - and --json both want standard output; give the video a file name");
}

void report_rendered(const Console& console, bool is_checked, const Rendered& rendered, double wall_s) {
    if (rendered.kept_frames > 0)
        console.info(fmt::format("{} were there already", counted(rendered.kept_frames, "frame")));
    if (!rendered.left_out.empty())
        console.warning(fmt::format("--from cannot repeat the output, because {}; keep the scene file",
                                    rendered.left_out));
    console.info(fmt::format("{} in {:.3g} s, {:.1f} per second{}", counted(rendered.frames, "frame"), wall_s,
                             static_cast<double>(rendered.frames) / wall_s, is_checked ? "; checked" : ""));
}

/// A longer film may have been there before.
void warn_of_other_pictures(const Console& console, const std::string& output, std::int64_t end) {
    if (media::find_ending(output).kind != media::FileKind::kPictures) return;
    const std::string next = media::picture_name(output, end);
    if (is_there(next))
        console.warning(fmt::format(
            "{} exists but is not part of this render, which ends before it; remove it and those after "
            "it before the pictures are used as a video",
            next));
}

/// Refuses frames beside others of another size in the same folder: together they are no video.
void check_adjacent_pictures(const VideoDef& video, const std::string& output, std::int64_t first,
                             std::int64_t end) {
    if (media::find_ending(output).kind != media::FileKind::kPictures) return;
    for (const std::int64_t frame : {first - 1, end}) {
        const std::string path = frame < 0 ? "" : media::picture_name(output, frame);
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(path, ignored) || !media::is_png(path)) continue;
        const Image other = read_png(path);
        if (other.width() == video.width_px && other.height() == video.height_px) continue;
        throw_usage(
            "{} has {}x{} pixels, and these frames would have {}x{}; give --size {}x{}, another folder, or "
            "--force if you replace the others as well",
            path, other.width(), other.height(), video.width_px, video.height_px, other.width(),
            other.height());
    }
}

ExitCode render(const Console& console, const RenderOptions& options) {
    const double start_s = now_s();
    auto [scene, origin] = load(console, options.scene);
    if (options.pad) {
        set_size(scene, scene.video.width_px + scene.video.width_px % 2,
                 scene.video.height_px + scene.video.height_px % 2);
    }
    const RenderDef def = render_def(options, origin.frames);
    check_standard_output(console, options.output);
    const CheckedOutput output = check_render(scene, options.output, def, options.scene.input());
    const VideoDef& video = output.video().def;
    if (!options.frames.empty() && !options.force)
        check_adjacent_pictures(video, options.output, output.first(), output.end());
    report_format(console, scene, output);

    const Film film = make_film(console, scene, options.film, "simulate");
    const std::int64_t count = output.video().frames();
    console.info(
        fmt::format("{}: {}, method {}; {} of {}x{} at {} per second{}", scene.name,
                    system_text(film.system()), method_names(film.plan()), counted(count, "frame"),
                    scene.video.width_px, scene.video.height_px, scene.video.fps.rational().text(),
                    scene.video.speed == Rational{1, 1} ? "" : ", at speed " + scene.video.speed.text()));
    warn_of_room(console, film);
    if (options.dry_run) {
        console.report(film_json(film));
        return ExitCode::kOk;
    }

    const GlInfo gl = film.gl();
    report_gl(console, gl);
    std::optional<Progress> progress(std::in_place, console, "render", count);
    const Rendered rendered = render_video(film, output, [&](std::int64_t done, std::int64_t total) {
        progress->update(total > 0 ? done * count / total : done);
        return interruption() == ExitCode::kOk;
    });
    progress.reset();
    if (rendered.reader_left) return ExitCode::kOk;
    if (!rendered.complete) throw Error(interruption(), words_of_interruption(options, count, rendered));

    const double wall_s = now_s() - start_s;
    report_rendered(console, is_one_file(options.output), rendered, wall_s);
    warn_of_branch(console, film);
    if (!def.end) warn_of_other_pictures(console, options.output, output.end());
    if (!is_standard_output(options.output)) console.result(options.output);
    console.report(report(film, video, options, rendered, wall_s, gl.renderer));
    return report_empty(console, {rendered.empty_frames, rendered.frames, rendered.first_empty_s},
                        options.fail_empty, scene.camera);
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
    auto [command, options] = add_command(app, action, "render", "turn a scene into a video", render);
    add_scene(command, options.scene);
    add_from(command, options.scene);
    add_positions(command, options.scene);
    command.add_option("-o,--output", options.output, "the ending chooses the format: " + endings_text())
        ->required();
    add_size(command, options.scene);
    command.add_flag("--pad", options.pad, "make odd sides even, by a column or a row more, as 4:2:0 needs");
    add_timing(command, options.scene, "frames per second, e.g. 60 or 30000/1001");
    add_shortcut(command, options.scene, "--crf", "video.crf",
                 "quality, 1 (best) .. 51 of H.264 and H.265, .. 63 of AV1 and VP9");
    add_shortcut(command, options.scene, "--preset", "video.preset",
                 "speed: ultrafast .. placebo, of AV1 and VP9 0 (slowest) .. 13, .. 8");
    add_shortcut(command, options.scene, "--codec", "video.codec", "encoder, if not the ending's default");
    add_shortcut(command, options.scene, "--pix", "video.pix",
                 "pixels: 420, 444 (sharper coloured edges; browsers and QuickTime refuse H.264 "
                 "High 4:4:4) or rgba");
    add_shortcut(command, options.scene, "--threads", "video.threads",
                 "threads of the encoder, on which the bytes depend");
    add_shortcut(command, options.scene, "--jobs", "video.jobs", "threads that draw; 0: one per core");
    command.add_option("--frames", options.frames, "only frames FIRST <= k < END")->type_name("FIRST:END");
    add_gl(command, options.film);
    add_fail_empty(command, options.fail_empty);
    command.add_flag("--force", options.force, "replace an existing output");
    command.add_flag("--resume", options.resume, "of pictures: draw those that are missing or damaged");
    command.add_flag("--dry-run", options.dry_run, "check everything but OpenGL, and write nothing");
}

}  // namespace corda::app
