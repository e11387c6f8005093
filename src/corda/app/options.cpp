#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"

namespace corda::app {
namespace {

/// Warns of texts that no frame shows, or none in full. They are no error: a shorter film may be a preview.
void warn_of_unseen_texts(const Console& console, const Scene& scene) {
    const double end_s = scene.world.duration_s;
    for (std::size_t i = 0; i < scene.overlay.texts.size(); ++i) {
        const OverlayTextDef& text = scene.overlay.texts[i];
        // A text fades in, and out if it ends before the film.
        const double fades = text.to_s ? 2.0 : 1.0;
        const double shown_s = text.to_s.value_or(end_s) - text.from_s;
        if (text.from_s >= end_s) {
            console.warning(fmt::format(
                "{}: overlay.texts[{}].from: {} s is not before the end of the film at {} s, so that no "
                "frame shows the text; give an earlier time, or a longer world.duration",
                scene.source, i, text.from_s, end_s));
        } else if (fades * text.fade_s > shown_s) {
            console.warning(
                fmt::format("{}: overlay.texts[{}].fade: {} s is too long for a text that is there for "
                            "{:.6g} s, so that it is never fully "
                            "visible; give at most {:.6g}",
                            scene.source, i, text.fade_s, shown_s, shown_s / fades));
        }
    }
}

/// Warns of pins let go, links cut and paths that begin when the film is over: no error, as above.
void warn_of_late_events(const Console& console, const Scene& scene) {
    const double end_s = scene.world.duration_s;
    std::string first;
    int late = 0;
    const auto look = [&](const std::string& key, double time_s) {
        if (time_s >= end_s && late++ == 0) first = fmt::format("{}: {} s is", key, time_s);
    };
    const auto look_at_body = [&](const std::string& body, const auto& def) {
        for (std::size_t i = 0; i < def.releases.size(); ++i)
            look(fmt::format("{}.release[{}].t", body, i), def.releases[i].time_s);
        for (std::size_t i = 0; i < def.cuts.size(); ++i)
            look(fmt::format("{}.cut[{}].t", body, i), def.cuts[i].time_s);
        for (std::size_t i = 0; i < def.moves.size(); ++i)
            if (const auto& path = def.moves[i].path; !path.empty())
                look(fmt::format("{}.moves[{}].path[0].t", body, i), path.front().time_s);
    };
    for (std::size_t i = 0; i < scene.ropes.size(); ++i)
        look_at_body(fmt::format("rope[{}]", i), scene.ropes[i]);
    for (std::size_t i = 0; i < scene.nets.size(); ++i)
        look_at_body(fmt::format("net[{}]", i), scene.nets[i]);
    const std::vector<CameraKeyDef>& path = scene.camera.path;
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
        look(fmt::format("camera.path[{}].t", i), path[i].time_s);
    if (late == 0) return;
    console.warning(fmt::format(
        "{}: {} not before the end of the film at {} s, so that nothing happens{}; give an earlier time, or "
        "a longer world.duration",
        scene.source, first, end_s, late == 1 ? "" : fmt::format(" ({} more events are as late)", late - 1)));
}

/// Whoever made the file must not decide how much memory this machine gives.
void check_size_from_file(const SceneOptions& options, const VideoDef& video) {
    constexpr std::int64_t kMaxUnaskedPx = std::int64_t{1} << 25;
    constexpr double kBytesPerPx = 12.0;         // measured: 775 MB for 16384x4096
    constexpr double kBytesPerEncodedPx = 25.0;  // 1640 MB by libx264 with the preset ultrafast
    const std::int64_t pixels = std::int64_t{video.width_px} * video.height_px;
    const auto gives_size = [](const Setting& setting) { return setting.starts_with("video.size"); };
    if (pixels <= kMaxUnaskedPx || std::ranges::any_of(options.settings, gives_size) ||
        std::ranges::any_of(options.shortcuts, gives_size))
        return;
    throw_error(ExitCode::kInvalidScene,
                "{}: its scene asks for {}x{} pixels, which take some {:.1f} GB to draw and {:.1f} GB or "
                "more to encode; allow that by --size {}x{}, or give a smaller size",
                options.from, video.width_px, video.height_px,
                static_cast<double>(pixels) * kBytesPerPx * 1e-9,
                static_cast<double>(pixels) * kBytesPerEncodedPx * 1e-9, video.width_px, video.height_px);
}

/// "video.size=[640,360]" for "640x360". Throws corda::Error (kUsage).
std::string size_setting(const std::string& text) {
    for (const NamedSize& named : kNamedSizes)
        if (named.name == text) return fmt::format("video.size=\"{}\"", text);
    const auto cross = text.find('x');
    const auto is_number = [](const std::string& part) {
        return !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    };
    const std::string width = text.substr(0, cross);
    const std::string height = cross == std::string::npos ? "" : text.substr(cross + 1);
    if (!is_number(width) || !is_number(height)) {
        throw_usage("--size {}: is not WIDTHxHEIGHT; write e.g. 1920x1080, 4k, 1080p, square or portrait",
                    text);
    }
    return fmt::format("video.size=[{}, {}]", width, height);
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

const CLI::App* find_command(const CLI::App& app, std::string_view name) {
    const auto found =
        app.get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
    return found.empty() ? nullptr : found.front();
}

std::string advice(std::string_view word, const std::vector<std::string>& known) {
    const std::vector<std::string_view> candidates(known.begin(), known.end());
    const auto meant = nearest(word, candidates);
    return meant ? fmt::format("did you mean {}?", *meant)
                 : fmt::format("known are {}", fmt::join(known, ", "));
}

CLI::Validator within(double low, double high) {
    const std::string range = fmt::format("{} .. {}", low, high);
    const auto check = [=](const std::string& text) {
        double value = 0.0;
        const bool is_within = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return is_within ? std::string() : fmt::format("\"{}\" is not a number within {}", text, range);
    };
    return {check, range};
}

void SceneOptions::require() const {
    if (input().empty()) throw CLI::RequiredError("SCENE, or --from,");
}

void add_scene(CLI::App& command, SceneOptions& scene) {
    command.add_option("SCENE", scene.path, "scene file (TOML), or - for standard input")->required();
    // One value per flag: a value may have commas and brackets of its own.
    command.add_option("--set", scene.settings, "override a key of the scene, e.g. rope[0].mass=2")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
}

void add_from(CLI::App& command, SceneOptions& scene) {
    CLI::Option* path = command.get_option("SCENE")->required(false);
    command
        .add_option("--from", scene.from,
                    "repeat a picture or a video of corda: take the scene that it carries in place of SCENE")
        ->type_name("FILE")
        ->excludes(path);
}

void add_positions(CLI::App& command, SceneOptions& scene) {
    command
        .add_option(
            "--positions", scene.positions,
            "draw these positions in place of a simulation: CSV as simulate writes it (t, x0, y0, ...; - for "
            "standard input), or .npz with the arrays times and positions; world.duration is their last "
            "time, if nothing gives it")
        ->type_name("FILE");
}

void add_shortcut(CLI::App& command, SceneOptions& scene, const std::string& name, const std::string& key,
                  const std::string& help) {
    const std::size_t dot = key.find('.');
    const scene::Key& row = *scene::find_key(key.substr(0, dot), key.substr(dot + 1));
    const auto check = [&row](const std::string& text) {
        double value = 0.0;
        const bool is_finite = !CLI::detail::lexical_cast(text, value) || std::isfinite(value);
        return is_finite ? std::string()
                         : fmt::format("{} is not a finite number; {}", text, scene::remedy(row));
    };
    command
        .add_option_function<std::string>(
            name,
            [&scene, key, is_word = row.type.kind == scene::Kind::kChoice](const std::string& value) {
                // A word may look like a number.
                const bool is_digits = value.find_first_not_of("0123456789") == std::string::npos;
                scene.shortcuts.push_back(key + "=" + (is_word && is_digits ? "'" + value + "'" : value));
            },
            help + " (--set " + key + ")")
        ->check(check);
}

void add_size(CLI::App& command, SceneOptions& scene) {
    command
        .add_option_function<std::string>(
            "--size", [&scene](const std::string& value) { scene.shortcuts.push_back(size_setting(value)); },
            "picture size in pixels, or 4k, 1080p, square or portrait (--set video.size)")
        ->type_name("WxH|NAME");
}

void add_timing(CLI::App& command, SceneOptions& scene, const std::string& rate) {
    add_shortcut(command, scene, "--fps", "video.fps", rate);
    add_shortcut(command, scene, "--duration", "world.duration", "seconds");
}

void add_gl(CLI::App& command, FilmDef& film) {
    command
        .add_option("--backend", film.backend,
                    "how to reach OpenGL: auto, device, device:N, surfaceless or default")
        ->envname("CORDA_BACKEND");
    command.add_flag("--require-gpu", film.require_gpu, "refuse to draw on the CPU (exit 4)");
}

std::vector<CLI::Option*> add_server(CLI::App& command, serve::ServerDef& server) {
    auto* const port =
        command.add_option("--port", server.port, "port of the page; 0: any that is free; its address stays")
            ->check(within(0, 65535));
    auto* const bind = command
                           .add_option("--bind", server.bind,
                                       "address that the page is served at: 127.0.0.1, this machine alone; "
                                       "0.0.0.0 or ::, all of its networks")
                           ->type_name("ADDRESS");
    auto* const host =
        command
            .add_option("--host", server.hosts,
                        "a name other than localhost by which browsers reach the page, or a page that shows "
                        "it in a frame, such as a notebook's")
            ->type_name("NAME");
    auto* const token =
        command.add_option("--token", server.token, "the secret in the address, in place of a random one")
            ->type_name("TEXT");
    return {port, bind, host, token};
}

void tell_address(const Console& console, const serve::Server& server) {
    console.result(server.address());
    for (const std::string& address : server.other_addresses())
        console.info("from other machines: " + address);
}

void add_fail_empty(CLI::App& command, bool& fails) {
    command.add_flag("--fail-empty", fails, "exit 7 if nothing is in view in a picture");
}

Loaded load(const Console& console, const SceneOptions& options) {
    if (options.path == "-" && options.positions == "-")
        throw_usage("SCENE and --positions are both standard input; give one of them as a file");
    Loaded loaded;
    if (!options.from.empty()) loaded.origin = read_provenance(options.from);
    if (!options.from.empty() && loaded.origin.corda != version())
        console.warning(fmt::format("{} was made by corda {}, this is {}: pixels may differ", options.from,
                                    loaded.origin.corda, version()));
    const std::string text = options.from.empty() ? scene::read_file(options.path) : "";
    const auto parse = [&](const std::vector<Setting>& settings) {
        return options.from.empty() ? parse_scene(text, scene::source_name(options.path), settings)
                                    : scene_of(loaded.origin, options.from, settings);
    };
    std::vector<Setting> settings = options.settings;
    settings.insert(settings.end(), options.shortcuts.begin(), options.shortcuts.end());
    try {
        loaded.scene = parse(settings);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kInvalidScene || options.shortcuts.empty()) throw;
        try {
            static_cast<void>(parse(options.settings));
        } catch (const Error&) {
            throw Error(ExitCode::kInvalidScene, error.problems());
        }
        throw Error(ExitCode::kUsage, error.problems());
    }
    if (!options.from.empty()) check_size_from_file(options, loaded.scene.video);
    if (!options.positions.empty()) give_motion(loaded.scene, read_positions(options.positions));
    warn_of_unseen_texts(console, loaded.scene);
    warn_of_late_events(console, loaded.scene);
    return loaded;
}

void set_size(Scene& scene, int width_px, int height_px) {
    scene.video.width_px = width_px;
    scene.video.height_px = height_px;
    scene.settings.push_back(fmt::format("video.size=[{}, {}]", width_px, height_px));
}

std::optional<RequestedFrames> parse_frames(std::string_view text) {
    const auto colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto first = whole_number<std::int64_t>(text.substr(0, colon));
    const auto end = whole_number<std::int64_t>(text.substr(colon + 1));
    const bool is_range = (first || colon == 0) && (end || colon + 1 == text.size());
    return is_range ? std::optional(RequestedFrames{first.value_or(0), end}) : std::nullopt;
}

}  // namespace corda::app
