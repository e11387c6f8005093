#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/core/timeline.hpp"
#include "corda/scene/read_file.hpp"
#include "corda/scene/schema.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/view/font.hpp"

namespace corda::app {
namespace {

/// Loads a scene with settings. Those in `of_options` came from options such as --crf: if the scene is valid
/// without them, the command line is wrong (kUsage), not the scene.
Scene load_with(const std::vector<Setting>& settings, const std::vector<Setting>& of_options,
                const std::function<Scene(const std::vector<Setting>&)>& load) {
    try {
        return load(settings);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kInvalidScene || of_options.empty()) throw;
        std::vector<Setting> others = settings;
        std::erase_if(others, [&of_options](const Setting& setting) {
            return std::ranges::find(of_options, setting) != of_options.end();
        });
        try {
            static_cast<void>(load(others));
        } catch (const Error&) {
            throw Error(ExitCode::kInvalidScene, error.problems());
        }
        throw Error(ExitCode::kUsage, error.problems());
    }
}

/// Warns of texts that no frame shows. They are no error: a shorter film may be a preview.
void warn_of_unseen_texts(const Console& console, const Scene& scene) {
    for (std::size_t i = 0; i < scene.overlay.texts.size(); ++i) {
        const double from_s = scene.overlay.texts[i].from_s;
        if (from_s < scene.world.duration_s) continue;
        console.warning(fmt::format(
            "{}: overlay.texts[{}].from: {} s is not before the end of the film at {} s, so that no "
            "frame shows the text; give an earlier time, or a longer world.duration",
            scene.source, i, from_s, scene.world.duration_s));
    }
}

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

}  // namespace

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

void SceneOptions::add_to(CLI::App& command) {
    command.add_option("SCENE", path, "scene file (TOML), or - for standard input")->required();
    // One value per flag: a value may have commas and brackets of its own.
    command.add_option("--set", settings, "override a key of the scene, e.g. rope[0].mass=2")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
}

void SceneOptions::add_from(CLI::App& command) {
    CLI::Option* scene = command.get_option("SCENE")->required(false);
    command
        .add_option("--from", from_,
                    "repeat a picture or a video of corda: take the scene that it carries in place of SCENE")
        ->type_name("FILE")
        ->excludes(scene);
}

void SceneOptions::require() const {
    if (path.empty() && from_.empty()) throw CLI::RequiredError("SCENE, or --from,");
}

const Provenance& SceneOptions::provenance(const Console& console) const {
    if (provenance_) return *provenance_;
    provenance_ = read_provenance(from_);
    if (provenance_->corda != version())
        console.warning(fmt::format("{} was made by corda {}, this is {}: pixels may differ", from_,
                                    provenance_->corda, version()));
    return *provenance_;
}

/// Whoever made the file must not decide how much memory this machine gives.
void SceneOptions::check_size_from_file(const VideoDef& video) const {
    constexpr std::int64_t kMaxUnaskedPx = std::int64_t{1} << 25;
    constexpr double kBytesPerPx = 12.0;         // measured: 775 MB for 16384x4096
    constexpr double kBytesPerEncodedPx = 25.0;  // 1640 MB by libx264 with the preset ultrafast
    const std::int64_t pixels = std::int64_t{video.width_px} * video.height_px;
    if (pixels <= kMaxUnaskedPx || gives_size()) return;
    throw_error(ExitCode::kInvalidScene,
                "{}: its scene asks for {}x{} pixels, which take some {:.1f} GB to draw and {:.1f} GB or "
                "more to encode; allow that by --size {}x{}, or give a smaller size",
                from_, video.width_px, video.height_px, static_cast<double>(pixels) * kBytesPerPx * 1e-9,
                static_cast<double>(pixels) * kBytesPerEncodedPx * 1e-9, video.width_px, video.height_px);
}

bool SceneOptions::gives_size() const {
    return std::ranges::any_of(settings,
                               [](const Setting& setting) { return setting.starts_with("video.size"); });
}

Scene SceneOptions::load_from(const Provenance& origin) const {
    return load_with(settings, of_options_,
                     [&](const std::vector<Setting>& some) { return scene_of(origin, from_, some); });
}

Scene SceneOptions::load(const Console& console) const {
    Scene scene = is_from() ? load_from(provenance(console)) : parse({}, {}, {});
    if (is_from()) check_size_from_file(scene.video);
    warn_of_unseen_texts(console, scene);
    return scene;
}

Scene SceneOptions::parse(const std::vector<Setting>& more, std::string_view text,
                          const std::string& name) const {
    if (!path.empty() && !text_) text_ = scene::read_file(path);
    std::vector<Setting> all = settings;
    all.insert(all.end(), more.begin(), more.end());
    std::vector<Setting> of_options = of_options_;
    of_options.insert(of_options.end(), more.begin(), more.end());
    return load_with(all, of_options, [&](const std::vector<Setting>& some) {
        return path.empty() ? parse_scene(text, name, some)
                            : parse_scene(*text_, scene::source_name(path), some);
    });
}

void SceneOptions::add_shortcut(CLI::App& command, const std::string& name, const std::string& key,
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
            [this, key, is_word = row.type.kind == scene::Kind::kChoice](const std::string& value) {
                // A word may look like a number.
                const bool is_digits = value.find_first_not_of("0123456789") == std::string::npos;
                settings.push_back(key + "=" + (is_word && is_digits ? "'" + value + "'" : value));
                of_options_.push_back(settings.back());
            },
            help + " (--set " + key + ")")
        ->check(check);
}

void set_size(Scene& scene, int width_px, int height_px) {
    scene.video.width_px = width_px;
    scene.video.height_px = height_px;
    scene.settings.push_back(fmt::format("video.size=[{}, {}]", width_px, height_px));
}

void SceneOptions::add_size(CLI::App& command) {
    command
        .add_option_function<std::string>(
            "--size",
            [this](const std::string& value) {
                settings.push_back(size_setting(value));
                of_options_.push_back(settings.back());
            },
            "picture size in pixels, or 4k, 1080p, square or portrait (--set video.size)")
        ->type_name("WxH|NAME");
}

void SceneOptions::add_timing(CLI::App& command, const std::string& rate) {
    add_shortcut(command, "--fps", "video.fps", rate);
    add_shortcut(command, "--duration", "world.duration", "seconds");
}

void GlOptions::add_to(CLI::App& command) {
    command
        .add_option("--backend", backend,
                    "how to reach OpenGL: auto, device, device:N, surfaceless or default")
        ->envname("CORDA_BACKEND");
    command.add_flag("--require-gpu", require_gpu, "refuse to draw on the CPU (exit 4)");
}

void GlOptions::apply_to(FilmDef& film) const {
    if (!backend.empty()) film.backend = backend;
    film.require_gpu = require_gpu;
}

void report_gl(const Console& console, const GlInfo& gl) {
    console.detail(fmt::format("drawing with {} ({}), OpenGL {}, by {}", gl.renderer, gl.vendor, gl.version,
                               gl.platform));
}

Shard parse_shard(const std::string& text) {
    Shard shard;
    const bool is_read = std::sscanf(text.c_str(), "%" SCNd64 "/%" SCNd64, &shard.index, &shard.count) == 2;
    if (!is_read || fmt::format("{}/{}", shard.index, shard.count) != text || shard.index < 0 ||
        shard.index >= shard.count)
        throw_usage("--shard {}: is not I/N, the number of this shard (0 .. N - 1) and how many there are",
                    text);
    return shard;
}

std::optional<RequestedFrames> parse_frames(std::string_view text) {
    const auto colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto first = whole_number<std::int64_t>(text.substr(0, colon));
    const auto end = whole_number<std::int64_t>(text.substr(colon + 1));
    const bool is_range = (first || colon == 0) && (end || colon + 1 == text.size());
    return is_range ? std::optional(RequestedFrames{first.value_or(0), end}) : std::nullopt;
}

void TimeOptions::add_to(CLI::App& command) {
    auto* at = command.add_option("--at", times_s, "times in seconds, e.g. 0,0.5,1.25")
                   ->delimiter(',')
                   ->type_name("T[,T...]");
    auto* frame =
        command.add_option("--frame", frames, "frames of the video from 0, or ranges FIRST <= k < END")
            ->delimiter(',')
            ->type_name("K|FIRST:END[,...]");
    at->excludes(frame);
}

void TimeOptions::require() const {
    if (times_s.empty() && frames.empty()) throw CLI::RequiredError("--at or --frame");
}

std::vector<RequestedTime> TimeOptions::list(const Scene& scene) const {
    std::vector<RequestedTime> times;
    for (const double time_s : times_s) {
        const auto within_s = time_within(time_s, scene.world.duration_s);
        if (!within_s) {
            throw_usage("--at {}: is not within 0 .. {} s; world.duration sets the end", time_s,
                        scene.world.duration_s);
        }
        times.push_back({*within_s, std::nullopt});
    }
    for (const std::string& word : frames) {
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

}  // namespace corda::app
