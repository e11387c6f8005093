#include "corda/bench/bench.hpp"
#include "corda/bench/presets.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/media/format/format.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct BenchOptions {
    SceneOptions scene;
    GlOptions gl;
    std::vector<std::string> sizes{"1280x720", "1920x1080", "3840x2160"};
    std::vector<std::string> presets{"ultrafast", "veryfast", "medium"};
    bench::BenchDef def;

    bool encodings = false;

    /// The scene of one case: ten seconds of the example `first` if none is named.
    [[nodiscard]] Scene scene_of(const std::string& size, const std::string& preset) const {
        return scene_of({size_setting(size), "video.preset='" + preset + "'"});
    }

    [[nodiscard]] Scene scene_of(const std::vector<Setting>& own) const {
        return scene.parse(own, example_text("first"), "first.toml");
    }
};

nlohmann::json spread_json(const report::Times& times) {
    return {{"median", times.median()}, {"least", times.least()}, {"largest", times.largest()}};
}

nlohmann::json to_json(const VideoDef& video, const bench::Measured& measured) {
    const auto frames = static_cast<double>(measured.frames);
    nlohmann::json stages = nlohmann::json::array();
    for (const bench::Stage& stage : measured.stages) {
        stages.push_back(
            {{"name", stage.name}, {"ms_per_frame", 1e3 * stage.wall_s / frames}, {"cpu_s", stage.cpu_s}});
    }
    return {
        {"width", video.width_px},
        {"height", video.height_px},
        {"preset", video.encoder.preset},
        {"frames", measured.frames},
        {"jobs", measured.jobs},
        {"fps", frames / measured.render_s.median()},
        {"encoder_fps", frames / measured.encoder_s.median()},
        {"ratio_to_encoder", measured.ratio.median()},
        {"render_s", spread_json(measured.render_s)},
        {"encoder_s", spread_json(measured.encoder_s)},
        {"ratio", spread_json(measured.ratio)},
        {"encoder_pictures", measured.pictures},
        {"peak_rss_mib", measured.peak_rss_mib},
        {"encoder_rss_mib", measured.encoder_rss_mib},
        {"rss_per_job_mib", measured.rss_per_job_mib ? nlohmann::json(*measured.rss_per_job_mib) : nullptr},
        {"stages", stages}};
}

void report_in_words(const Console& console, const VideoDef& video, const bench::Measured& measured) {
    const auto frames = static_cast<double>(measured.frames);
    console.result(fmt::format(
        "{}x{} {}: {:.1f} frames per second, x264 alone {:.1f}; ratio of times {:.3f} ({:.3f} .. {:.3f})",
        video.width_px, video.height_px, video.encoder.preset, frames / measured.render_s.median(),
        frames / measured.encoder_s.median(), measured.ratio.median(), measured.ratio.least(),
        measured.ratio.largest()));
    std::string memory =
        fmt::format("  peak of memory {:.0f} MiB with {} at a time; one encoder {:.0f} MiB",
                    measured.peak_rss_mib, counted(measured.jobs, "chunk"), measured.encoder_rss_mib);
    if (measured.rss_per_job_mib)
        memory += fmt::format("; a further chunk adds {:.0f} MiB to it", *measured.rss_per_job_mib);
    else if (measured.jobs > 1)
        memory += "; the memory of a further chunk is too small to measure";
    console.result(memory);
    std::string text = "  one thread, ms per frame (CPU):";
    for (const bench::Stage& stage : measured.stages)
        text += fmt::format(" {} {:.2f} ({:.2f})", stage.name, 1e3 * stage.wall_s / frames,
                            1e3 * stage.cpu_s / frames);
    console.result(text);
}

/// x264 in 4:2:0 is what renders are measured beside.
void check_comparable(const media::Format& format) {
    const bool is_x264 = std::string_view(format.codec->name) == "libx264";
    if (is_x264 && std::string_view(format.pixel_format) == "yuv420p") return;
    throw Error(
        ExitCode::kUsage,
        fmt::format("the scene's video is {} in {}, and bench measures beside x264 in yuv420p; add --set "
                    "video.codec=h264 --set video.pix=420, or compare codecs with --presets",
                    format.codec->standard, format.pixel_format));
}

ExitCode measure_all(const Console& console, BenchOptions options) {
    options.def.on_wait = [] { stop_if_asked("interrupted; nothing was kept"); };
    options.gl.apply_to(options.def.film);
    nlohmann::json cases = nlohmann::json::array();
    std::vector<Scene> scenes;  // all are checked before the first is measured
    for (const std::string& size : options.sizes)
        for (const std::string& preset : options.presets) {
            scenes.push_back(options.scene_of(size, preset));
            media::check_video_def(scenes.back().video);
            check_comparable(media::find_format("video.mp4", scenes.back().video));
        }
    Progress progress(console, "bench", std::ssize(scenes));
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        progress.update(static_cast<std::int64_t>(i));
        options.def.scene = scenes[i];
        const bench::Measured measured = bench::measure(options.def);
        report_in_words(console, scenes[i].video, measured);
        cases.push_back(to_json(scenes[i].video, measured));
    }
    progress.update(std::ssize(scenes));
    console.report({{"schema", 1}, {"cases", cases}});
    return ExitCode::kOk;
}

nlohmann::json to_json(const bench::MeasuredEncoding& measured) {
    return {{"codec", measured.codec},
            {"preset", measured.preset},
            {"crf", measured.crf ? nlohmann::json(*measured.crf) : nullptr},
            {"pixels", measured.pixels},
            {"frames", measured.frames},
            {"ms_per_frame", 1e3 * measured.wall_s / static_cast<double>(measured.frames)},
            {"bytes", measured.bytes},
            {"edge_psnr_db", measured.edge_psnr_db},
            {"edge_ssim", measured.edge_ssim}};
}

/// Renders in the usual ways to encode, at the first size that was named.
ExitCode measure_encodings(const Console& console, const BenchOptions& options) {
    bench::EncodingDef def;
    options.gl.apply_to(def.film);
    def.frames = options.def.frames;
    def.on_wait = [] { stop_if_asked("interrupted; nothing was kept"); };
    const std::vector<bench::Encoding> encodings = bench::usual_encodings();
    nlohmann::json rows = nlohmann::json::array();
    console.result("codec  preset     crf  pixels    ms/frame    KB/s  PSNR dB     SSIM   (both at edges)");
    Progress progress(console, "bench", std::ssize(encodings));
    for (std::size_t i = 0; i < encodings.size(); ++i) {
        progress.update(static_cast<std::int64_t>(i));
        std::vector<Setting> settings = encodings[i].settings;
        settings.push_back(size_setting(options.sizes.front()));
        def.scene = options.scene_of(settings);
        def.ending = encodings[i].ending;
        try {
            const bench::MeasuredEncoding measured = bench::measure_encoding(def);
            const double duration_s = def.scene.video.fps.time_s(measured.frames);
            console.result(fmt::format("{:<6} {:<9} {:>4}  {:<8} {:>9.2f} {:>7.1f} {:>8.2f} {:>8.4f}",
                                       measured.codec, measured.preset,
                                       measured.crf ? std::to_string(*measured.crf) : "", measured.pixels,
                                       1e3 * measured.wall_s / static_cast<double>(measured.frames),
                                       1e-3 * static_cast<double>(measured.bytes) / duration_s,
                                       measured.edge_psnr_db, measured.edge_ssim));
            rows.push_back(to_json(measured));
        } catch (const Error& error) {
            if (error.code() != ExitCode::kEncoder) throw;
            console.warning(fmt::format("left out: {}", error.what()));
        }
    }
    progress.update(std::ssize(encodings));
    console.report({{"schema", 1}, {"encodings", rows}});
    return ExitCode::kOk;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* command =
        app.add_subcommand("bench", "measure renders beside x264 alone: time, stages and memory");
    options->scene.add_to(*command, SceneOptions::Need::kOptional);
    command->add_option("--size", options->sizes, "picture sizes in pixels, e.g. 1280x720,1920x1080")
        ->delimiter(',')
        ->type_name("WxH");
    command->add_option("--preset", options->presets, "x264 presets, e.g. veryfast,medium")->delimiter(',');
    command->add_option("--frames", options->def.frames, "most frames of each video")
        ->check(within(1, 1e6))
        ->capture_default_str();
    command->add_option("--repeats", options->def.repeats, "of each measurement")
        ->check(within(1, 1000))
        ->capture_default_str();
    options->scene.add_shortcut(*command, "--jobs", "video.jobs", "chunks made at a time; 0: one per core");
    command->add_flag("--presets", options->encodings,
                      "compare presets, crf and codecs instead, at the first size: time, bytes and quality");
    options->gl.add_to(*command);
    command->callback([options, &action] {
        std::vector<Setting>& settings = options->scene.settings;
        if (options->scene.path.empty()) settings.insert(settings.begin(), "world.duration=10");
        action = [options](const Console& console) {
            return options->encodings ? measure_encodings(console, *options) : measure_all(console, *options);
        };
    });
}

}  // namespace corda::app
