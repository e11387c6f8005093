// Renders beside x264 alone: time, stages and memory; or, with --encodings, presets, crf and codecs: time,
// bytes and quality. See tests/benchmark/run.sh.
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmark/video/encodings.hpp"
#include "benchmark/video/measure.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/media/format/format.hpp"

namespace corda::benchmark {
namespace {

struct Options {
    std::string path = CORDA_EXAMPLES "/first.toml";
    std::vector<Setting> settings;
    std::vector<std::string> sizes{"1280x720", "1920x1080", "3840x2160"};
    std::vector<std::string> presets{"ultrafast", "veryfast", "medium"};
    std::int64_t frames = 600;
    int repeats = 3;
    bool encodings = false;
    bool json = false;

    /// The scene, of ten seconds if it is the default, with settings of a case.
    [[nodiscard]] Scene scene_of(const std::string& size, std::vector<Setting> own) const {
        const std::size_t x = size.find('x');
        if (x == std::string::npos)
            throw Error(ExitCode::kUsage, fmt::format("--size {}: give WIDTHxHEIGHT", size));
        own.insert(own.begin(), settings.begin(), settings.end());
        own.push_back(fmt::format("video.size=[{}, {}]", size.substr(0, x), size.substr(x + 1)));
        return load_scene(path, own);
    }
};

volatile std::sig_atomic_t stop_signal = 0;

nlohmann::json spread_json(const study::Times& times) {
    return {{"median", times.median()}, {"least", times.least()}, {"largest", times.largest()}};
}

nlohmann::json to_json(const VideoDef& video, const Measured& measured) {
    const auto frames = static_cast<double>(measured.frames);
    nlohmann::json stages = nlohmann::json::array();
    for (const Stage& stage : measured.stages) {
        stages.push_back(
            {{"name", stage.name}, {"ms_per_frame", 1e3 * stage.wall_s / frames}, {"cpu_s", stage.cpu_s}});
    }
    return {{"width", video.width_px},
            {"height", video.height_px},
            {"preset", video.encoder.preset},
            {"frames", measured.frames},
            {"fps", frames / measured.render_s.median()},
            {"encoder_fps", frames / measured.encoder_s.median()},
            {"ratio_to_encoder", measured.ratio.median()},
            {"render_s", spread_json(measured.render_s)},
            {"encoder_s", spread_json(measured.encoder_s)},
            {"ratio", spread_json(measured.ratio)},
            {"encoder_pictures", measured.pictures},
            {"peak_rss_mib", measured.peak_rss_mib},
            {"encoder_rss_mib", measured.encoder_rss_mib},
            {"stages", stages}};
}

void print(const VideoDef& video, const Measured& measured) {
    const auto frames = static_cast<double>(measured.frames);
    fmt::print(
        "{}\n",
        fmt::format(
            "{}x{} {}: {:.1f} frames per second, x264 alone {:.1f}; ratio of times {:.3f} ({:.3f} .. {:.3f})",
            video.width_px, video.height_px, video.encoder.preset, frames / measured.render_s.median(),
            frames / measured.encoder_s.median(), measured.ratio.median(), measured.ratio.least(),
            measured.ratio.largest()));
    fmt::print("  peak of memory {:.0f} MiB; one encoder {:.0f} MiB\n", measured.peak_rss_mib,
               measured.encoder_rss_mib);
    std::string text = "  one thread, ms per frame (CPU):";
    for (const Stage& stage : measured.stages)
        text += fmt::format(" {} {:.2f} ({:.2f})", stage.name, 1e3 * stage.wall_s / frames,
                            1e3 * stage.cpu_s / frames);
    fmt::print("{}\n", text);
}

/// The encoder alone is x264 in 4:2:0.
void check_comparable(const media::Format& format) {
    const bool is_x264 = std::string_view(format.codec->name) == "libx264";
    if (is_x264 && std::string_view(format.pixel_format) == "yuv420p") return;
    throw Error(ExitCode::kUsage,
                fmt::format("the scene's video is {} in {}, not x264 in yuv420p; add --set video.codec=h264 "
                            "--set video.pix=420, or compare codecs with --encodings",
                            format.codec->standard, format.pixel_format));
}

nlohmann::json measure_all(const Options& options) {
    std::vector<Scene> scenes;  // all are checked before the first is measured
    for (const std::string& size : options.sizes)
        for (const std::string& preset : options.presets) {
            scenes.push_back(options.scene_of(size, {"video.preset='" + preset + "'"}));
            media::check_video_def(scenes.back().video);
            check_comparable(media::find_format("video.mp4", scenes.back().video));
        }
    nlohmann::json cases = nlohmann::json::array();
    for (const Scene& scene : scenes) {
        const Measured measured = measure({scene, {}, options.frames, options.repeats});
        if (!options.json) print(scene.video, measured);
        cases.push_back(to_json(scene.video, measured));
    }
    return {{"schema", 1}, {"cases", cases}};
}

nlohmann::json to_json(const MeasuredEncoding& measured) {
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

/// Renders in the usual ways to encode, at the first size.
nlohmann::json measure_encodings(const Options& options) {
    nlohmann::json rows = nlohmann::json::array();
    if (!options.json)
        fmt::print("codec  preset     crf  pixels    ms/frame    KB/s  PSNR dB     SSIM   (both at edges)\n");
    for (const Encoding& encoding : usual_encodings()) {
        const Scene scene = options.scene_of(options.sizes.front(), encoding.settings);
        try {
            const MeasuredEncoding measured = measure_encoding({scene, {}, encoding.ending, options.frames});
            rows.push_back(to_json(measured));
            if (options.json) continue;
            const double duration_s = scene.video.fps.time_s(measured.frames);
            fmt::print("{:<6} {:<9} {:>4}  {:<8} {:>9.2f} {:>7.1f} {:>8.2f} {:>8.4f}\n", measured.codec,
                       measured.preset, measured.crf ? std::to_string(*measured.crf) : "", measured.pixels,
                       1e3 * measured.wall_s / static_cast<double>(measured.frames),
                       1e-3 * static_cast<double>(measured.bytes) / duration_s, measured.edge_psnr_db,
                       measured.edge_ssim);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kEncoder) throw;
            fmt::print(stderr, "left out: {}\n", error.what());
        }
    }
    return {{"schema", 1}, {"encodings", rows}};
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Renders beside x264 alone: time, stages and memory", "run.sh video");
    app.add_option("SCENE", options.path, "scene file (TOML)")->capture_default_str();
    app.add_option("--set", options.settings, "override a key of the scene")->expected(1)->take_all();
    app.add_option("--size", options.sizes, "picture sizes in pixels")->delimiter(',');
    app.add_option("--preset", options.presets, "x264 presets")->delimiter(',');
    app.add_option("--frames", options.frames, "largest number of frames of each video")
        ->check(CLI::Range(1, 1'000'000));
    app.add_option("--repeats", options.repeats, "of each measurement")->check(CLI::Range(1, 1000));
    app.add_flag("--encodings", options.encodings,
                 "compare presets, crf and codecs at the first size: time, bytes and quality");
    app.add_flag("--json", options.json, "print JSON");
    CLI11_PARSE(app, argc, argv);
    if (app.count("SCENE") == 0) options.settings.insert(options.settings.begin(), "world.duration=10");
    const nlohmann::json result = options.encodings ? measure_encodings(options) : measure_all(options);
    if (options.json) fmt::print("{}\n", result.dump());
    return 0;
}

}  // namespace
}  // namespace corda::benchmark

int main(int argc, char** argv) {
    for (const int signal : {SIGINT, SIGTERM})
        std::signal(signal, [](int number) { corda::benchmark::stop_signal = number; });
    const corda::CancelScope stopping([] {
        if (corda::benchmark::stop_signal == 0) return true;
        throw corda::Error(corda::ExitCode::kInterrupted, "interrupted; nothing was kept");
    });
    try {
        return corda::benchmark::run(argc, argv);
    } catch (const corda::Error& error) {
        fmt::print(stderr, "benchmark_video: {}\n", error.what());
        return static_cast<int>(error.code());
    }
}
