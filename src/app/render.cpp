#include <charconv>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/media/video_writer.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/player.hpp"
#include "interrupt.hpp"
#include "output.hpp"

namespace corda::app {
namespace {

struct RenderOptions {
    SceneOptions scene;
    GlOptions gl;
    std::string output;
    std::string frames;
    bool force = false;
    bool dry_run = false;
};

/// Frames first <= k < last.
struct FrameRange {
    std::int64_t first = 0;
    std::int64_t last = 0;
    [[nodiscard]] std::int64_t count() const { return last - first; }
};

std::int64_t parse_frame(const std::string& text, std::int64_t if_empty) {
    if (text.empty()) return if_empty;
    std::int64_t frame = -1;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), frame);
    return status == std::errc{} && stop == text.data() + text.size() ? frame : -1;
}

FrameRange parse_range(const std::string& text, std::int64_t frames) {
    if (text.empty()) return {0, frames};
    const auto colon = text.find(':');
    FrameRange range{-1, -1};
    if (colon != std::string::npos) {
        range = {parse_frame(text.substr(0, colon), 0), parse_frame(text.substr(colon + 1), frames)};
    }
    if (range.first < 0 || range.last > frames || range.first >= range.last) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("--frames {}: is not FIRST:END with 0 <= FIRST < END <= {} (END is not drawn)", text,
                        frames));
    }
    return range;
}

void check_video_name(const std::string& output) {
    if (std::filesystem::path(output).extension() == ".mp4") return;
    throw Error(ExitCode::kUsage,
                fmt::format("-o {}: the ending names the container, and .mp4 is the one there is", output));
}

/// What the file says of itself beside its pictures.
media::VideoMetadata metadata(const scene::Scene& scene, const FrameRange& range,
                              const std::optional<scene::AutoPlan>& proof) {
    nlohmann::json comment = {{"corda", CORDA_VERSION},
                              {"scene", scene.name},
                              {"method", sim::method_name(scene.solver.method)},
                              {"first_frame", range.first}};
    report_proof(proof, comment);
    return {scene.name, comment.dump()};
}

/// Draws and encodes the frames; returns how many.
std::int64_t draw_frames(const Console& console, const scene::Scene& scene, const FrameRange& range,
                         scene::Player& player, media::VideoWriter& writer) {
    render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
    Progress progress(console, "render", range.count());
    for (std::int64_t k = range.first; k < range.last; ++k) {
        if (interruption() != ExitCode::kOk) break;
        const PixelRect damage = renderer.render(player.at(scene.video.fps.time_s(k)));
        writer.write(renderer.image(), damage);
        progress.update(k + 1 - range.first);
    }
    return writer.frames();
}

nlohmann::json report(const scene::Scene& scene, const std::string& output, std::int64_t frames,
                      double wall_s, const scene::Player& player, const std::string& gl_renderer) {
    const sim::System& system = player.run().simulation().system();
    return {{"schema", 1},
            {"output", output},
            {"frames", frames},
            {"width", scene.video.width_px},
            {"height", scene.video.height_px},
            {"fps", scene.video.fps.per_second()},
            {"fps_exact", scene.video.fps.rational().text()},
            {"wall_s", wall_s},
            {"frames_per_wall_s", static_cast<double>(frames) / wall_s},
            {"method", sim::method_name(scene.solver.method)},
            {"particles", system.particle_count()},
            {"bars", system.bars.size()},
            {"encoder", scene.video.encoder.codec},
            {"gl_renderer", gl_renderer}};
}

ExitCode keep_interrupted(const Console& console, const RenderOptions& options, media::VideoWriter& writer,
                          const FrameRange& range) {
    const std::int64_t frames = writer.frames();
    const std::string kept = writer.abandon();
    console.warning(
        frames > 0
            ? fmt::format("interrupted: frames {}..{} of {} are in {}, which plays; {} was not written",
                          range.first, range.first + frames - 1, range.count(), kept, options.output)
            : fmt::format("interrupted before the first frame; {} was not written", options.output));
    return interruption();
}

/// The frames up to a divergence are kept, and the message says where.
[[noreturn]] void keep_diverged(const Error& error, const RenderOptions& options, media::VideoWriter& writer,
                                const FrameRange& range) {
    const std::int64_t frames = writer.frames();
    if (frames == 0) throw Error(error.code(), error.what());
    const std::string kept = writer.abandon();
    throw Error(error.code(),
                fmt::format("{}; frames {}..{} before it are in {}, which plays; {} was not written",
                            error.what(), range.first, range.first + frames - 1, kept, options.output));
}

ExitCode render(const Console& console, const RenderOptions& options) {
    const double start_s = now_s();
    scene::Scene scene = options.scene.load();
    const FrameRange range = parse_range(options.frames, scene::frame_count(scene));
    const gl::ContextDef context_def = options.gl.def();
    check_video_name(options.output);
    media::check_video_def(scene.video);
    check_output(options.output, options.scene.path, options.force);
    const auto proof = settle_method(console, scene);
    scene::Player player(scene, preparation(console, "fit the camera"));
    console.info(fmt::format("{}: {}, method {}; {} frames of {}x{} at {} a second", scene.name,
                             scene::describe(player.run().simulation().system()),
                             sim::method_name(scene.solver.method), range.count(), scene.video.width_px,
                             scene.video.height_px, scene.video.fps.rational().text()));
    if (options.dry_run) return ExitCode::kOk;

    const gl::Context context(context_def);
    report_gl(console, context);
    media::VideoWriter writer(options.output, scene.video, metadata(scene, range, proof));
    std::int64_t frames = 0;
    try {
        frames = draw_frames(console, scene, range, player, writer);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kDiverged) throw;
        keep_diverged(error, options, writer, range);
    }
    if (interruption() != ExitCode::kOk) return keep_interrupted(console, options, writer, range);
    writer.finish();
    const double wall_s = now_s() - start_s;
    console.info(fmt::format("{} frames in {:.3g} s, {:.1f} a second; verified", frames, wall_s,
                             static_cast<double>(frames) / wall_s));
    console.result(options.output);
    nlohmann::json json = report(scene, options.output, frames, wall_s, player, context.info().gl_renderer);
    report_proof(proof, json);
    console.report(json);
    return ExitCode::kOk;
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "turn a scene into a video");
    options->scene.add_to(*command);
    command->add_option("-o,--output", options->output, "video file (.mp4)")->required();
    options->scene.add_size(*command);
    options->scene.add_shortcut(*command, "--fps", "video.fps", "frames a second, e.g. 60 or 30000/1001");
    options->scene.add_shortcut(*command, "--duration", "world.duration", "seconds");
    options->scene.add_shortcut(*command, "--crf", "video.crf", "x264 quality, 1 (best) .. 51");
    options->scene.add_shortcut(*command, "--preset", "video.preset", "x264 preset, ultrafast .. placebo");
    options->scene.add_shortcut(*command, "--codec", "video.codec", "encoder");
    options->scene.add_shortcut(*command, "--threads", "video.threads", "threads of the encoder");
    command->add_option("--frames", options->frames, "only frames FIRST <= k < END")->type_name("FIRST:END");
    options->gl.add_to(*command);
    command->add_flag("--force", options->force, "replace an existing output");
    command->add_flag("--dry-run", options->dry_run, "check everything and write nothing");
    command->callback([options, &action] {
        action = [options](const Console& console) { return render(console, *options); };
    });
}

}  // namespace corda::app
