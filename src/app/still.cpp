#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/media/png.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/player.hpp"
#include "output.hpp"

namespace corda::app {
namespace {

struct StillOptions {
    SceneOptions scene;
    GlOptions gl;
    std::vector<double> times_s;
    std::vector<std::int64_t> frames;
    std::string output;
    double pixels_per_inch = 96.0;
    bool force = false;
    bool dry_run = false;
};

struct Shot {
    double time_s = 0.0;
    std::optional<std::int64_t> frame;
    std::string path;
};

bool is_file_name(const std::string& output) {
    return std::filesystem::path(output).extension() == ".png";
}

std::vector<Shot> list_shots(const StillOptions& options, const scene::Scene& scene) {
    std::vector<Shot> shots;
    for (const double time_s : options.times_s) {
        if (!std::isfinite(time_s) || time_s < 0.0 || time_s > scene.world.duration_s) {
            throw Error(ExitCode::kUsage,
                        fmt::format("--at {}: is not within 0 .. {} s; world.duration sets the end", time_s,
                                    scene.world.duration_s));
        }
        shots.push_back({time_s, std::nullopt, fmt::format("{}_t{:011.6f}.png", scene.name, time_s)});
    }
    const std::int64_t last = scene.video.fps.last_frame_within(scene.world.duration_s);
    for (const std::int64_t frame : options.frames) {
        if (frame < 0 || frame > last) {
            throw Error(ExitCode::kUsage, fmt::format("--frame {}: is not within 0 .. {}", frame, last));
        }
        shots.push_back(
            {scene.video.fps.time_s(frame), frame, fmt::format("{}_f{:06}.png", scene.name, frame)});
    }
    std::stable_sort(shots.begin(), shots.end(),
                     [](const Shot& a, const Shot& b) { return a.time_s < b.time_s; });
    const auto same = std::adjacent_find(shots.begin(), shots.end(),
                                         [](const Shot& a, const Shot& b) { return a.path == b.path; });
    if (same != shots.end()) {
        throw Error(ExitCode::kUsage,
                    fmt::format("two stills would both be {}; ask for each time once", same->path));
    }
    return shots;
}

void set_paths(const StillOptions& options, std::vector<Shot>& shots) {
    if (is_file_name(options.output)) {
        if (shots.size() != 1) {
            throw Error(ExitCode::kUsage, fmt::format("-o {}: is one file for {} stills; give a folder",
                                                      options.output, shots.size()));
        }
        shots.front().path = options.output;
    } else {
        for (Shot& shot : shots) shot.path = (std::filesystem::path(options.output) / shot.path).string();
        if (!options.dry_run) make_folder(options.output);
    }
    if (options.dry_run && !std::filesystem::is_directory(options.output)) return;
    for (const Shot& shot : shots) check_output(shot.path, options.scene.path, options.force);
}

media::PngInfo describe_shot(const Shot& shot, const scene::Scene& scene, double pixels_per_inch) {
    media::PngInfo info;
    info.pixels_per_inch = pixels_per_inch;
    info.text = {{"Software", "corda " CORDA_VERSION},
                 {"Title", scene.name},
                 {"Scene", scene.name},
                 {"Time", fmt::format("{} s", shot.time_s)}};
    if (shot.frame) info.text.emplace_back("Frame", fmt::format("{}", *shot.frame));
    return info;
}

ExitCode still(const Console& console, const StillOptions& options) {
    scene::Scene scene = options.scene.load();
    std::vector<Shot> shots = list_shots(options, scene);
    const gl::ContextDef context_def = options.gl.def();
    set_paths(options, shots);
    const auto proof = settle_method(console, scene);
    scene::Player player(scene, preparation(console, "fit the camera"));
    console.detail(fmt::format("{}: {}", scene.name, scene::describe(player.run().simulation().system())));
    nlohmann::json outputs = nlohmann::json::array();
    if (!options.dry_run) {
        const gl::Context context(context_def);
        report_gl(console, context);
        render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
        const sim::FrameWatch watch = preparation(console, "simulate");
        const FrameRate& fps = scene.video.fps;
        std::int64_t frame = 0;
        for (const Shot& shot : shots) {
            // Frame by frame, so that a signal is seen on the way.
            for (; fps.time_s(frame) < shot.time_s; ++frame) {
                watch(frame, scene::frame_count(scene));
                player.at(fps.time_s(frame));
            }
            renderer.render(player.at(shot.time_s));
            media::write_png(shot.path, renderer.image(),
                             describe_shot(shot, scene, options.pixels_per_inch));
        }
    }
    for (const Shot& shot : shots) {
        if (options.dry_run) console.info(fmt::format("would write {}", shot.path));
        if (!options.dry_run) console.result(shot.path);
        outputs.push_back({{"path", shot.path}, {"time_s", shot.time_s}});
    }
    nlohmann::json json = {{"schema", 1},
                           {"outputs", outputs},
                           {"width", scene.video.width_px},
                           {"height", scene.video.height_px},
                           {"method", sim::method_name(scene.solver.method)}};
    report_proof(proof, json);
    console.report(json);
    return ExitCode::kOk;
}

}  // namespace

void add_still(CLI::App& app, Action& action) {
    auto options = std::make_shared<StillOptions>();
    CLI::App* command = app.add_subcommand("still", "draw frames at exact times as PNG files");
    options->scene.add_to(*command);
    auto* at = command->add_option("--at", options->times_s, "times in seconds, e.g. 0,0.5,1.25")
                   ->delimiter(',')
                   ->type_name("T[,T...]");
    auto* frame = command->add_option("--frame", options->frames, "frames of the video, from 0")
                      ->delimiter(',')
                      ->type_name("K[,K...]");
    at->excludes(frame);
    command->add_option("-o,--output", options->output, "folder, or a .png file for one still")->required();
    options->scene.add_size(*command);
    options->scene.add_shortcut(*command, "--fps", "video.fps", "frames a second");
    options->scene.add_shortcut(*command, "--duration", "world.duration", "seconds");
    command->add_option("--ppi", options->pixels_per_inch, "pixels per inch, for the size in print")
        ->check(CLI::Range(1.0, 10000.0));
    options->gl.add_to(*command);
    command->add_flag("--force", options->force, "replace existing files");
    command->add_flag("--dry-run", options->dry_run, "check everything and write nothing");
    command->callback([options, &action] {
        if (options->times_s.empty() && options->frames.empty()) throw CLI::RequiredError("--at or --frame");
        action = [options](const Console& console) { return still(console, *options); };
    });
}

}  // namespace corda::app
