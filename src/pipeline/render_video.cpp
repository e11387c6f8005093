#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/clock.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/version.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/chunks/video_sink.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/encode/disk_space.hpp"
#include "corda/media/encode/job_memory.hpp"
#include "corda/media/encode/probe.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/media/verify/verify.hpp"
#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/pipeline/provenance.hpp"
#include "corda/pipeline/render_chunks.hpp"
#include "corda/pipeline/validate.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/view/colors.hpp"

namespace corda {
namespace {

constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

/// All that the bytes of a video follow from, by keys.
std::map<std::string, std::string> origin_of(const Scene& scene, const media::Format& format,
                                             std::int64_t first, std::int64_t end) {
    std::map<std::string, std::string> origin = digest(scene);
    origin["corda"] = version();
    origin["encoder"] = format.encoder_name();
    origin["libraries"] = format.library_versions();
    origin["frames"] = fmt::format("{}:{}", first, end);
    return origin;
}

/// A part of another render cannot be resumed, and what is no part is not replaced.
void check_part(const std::string& path, const std::map<std::string, std::string>& origin,
                const OnProgress& on_progress) {
    const std::string part = part_path(path);
    std::error_code ignored;
    const auto bytes = std::filesystem::file_size(part, ignored);
    if (ignored || bytes == 0) return;
    const auto fail = [&](const std::string& problem, const char* other = "make it a video (corda recover)") {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' {}, so --resume cannot continue it; {}, render to another name, or start "
                        "anew (--force without --resume)",
                        part, problem, other));
    };
    media::check_part_in_child(part, false, on_progress);
    const media::PartComment comment = media::part_comment(part, on_progress);
    if (comment.is_damaged) fail("is damaged in its first chunk", "move it away");
    if (!comment.text) {
        // A part of this render that breaks off in its first chunk holds nothing that would be lost.
        const std::string told = fmt::format("\"{}\":{}", media::kOriginKey, nlohmann::json(origin).dump());
        if (media::holds_in_front(part, told)) return;
        fail("holds no whole chunk of this render", "move it away");
    }
    const std::map<std::string, std::string> its = media::told_origin(*comment.text);
    if (its.empty()) fail("does not tell what it was rendered from");
    if (const auto changes = differences(origin, its); !changes.empty())
        fail("is of another render: " + differences_text(changes));
}

/// What the file says of itself beside its pictures.
media::VideoMetadata metadata(Film& film, std::int64_t first, std::int64_t end,
                              const std::map<std::string, std::string>& origin) {
    const Scene& scene = film.scene();
    const Plan& plan = film.plan();
    const std::string title = printable(film.scene().name);
    nlohmann::json comment = {{"corda", version()},           {"scene", title},
                              {"method", method_names(plan)}, {"first_frame", first},
                              {"error_bound_m", nullptr},     {"error_bound_px", nullptr},
                              {"horizon_s", nullptr}};
    if (plan.error_bound_m) comment["error_bound_m"] = *plan.error_bound_m;
    if (const auto bound_px = film.error_bound_px()) comment["error_bound_px"] = *bound_px;
    if (plan.horizon_s) comment["horizon_s"] = *plan.horizon_s;
    comment[media::kOriginKey] = origin;
    Provenance made = provenance_of(scene);
    // A picture tells its own frame alone: it has the bytes of the still.
    const std::string of_picture = provenance_text(made);
    made.frames = fmt::format("{}:{}", first, end);
    const std::string provenance = provenance_text(std::move(made));
    comment[kProvenanceKey] = nlohmann::json::parse(provenance);
    return {title, comment.dump(), !view::look_of(scene.style).ground.is_opaque(),
            [name = scene.name, fps = scene.video.fps, of_picture](std::int64_t frame) {
                return picture_info(name, fmt::format("{}", fps.time_s(frame)), std::to_string(frame),
                                    of_picture);
            }};
}

/// The frames up to a divergence are kept, and the message names their file.
[[noreturn]] void keep_diverged(const Error& error, const std::string& path, std::int64_t first,
                                media::VideoWriter& writer) {
    const std::int64_t frames = writer.frames();
    if (frames == 0) throw Error(error.code(), error.what());
    const std::string kept = writer.abandon();
    throw Error(error.code(),
                fmt::format("{}; frames {}..{} before it are in {}, which plays; {} was not written",
                            error.what(), first, first + frames - 1, kept, path));
}

/// How many chunks of so many frames to make at a time.
int jobs_for(const VideoDef& video, std::int64_t length, std::int64_t frames) {
    return static_cast<int>(
        std::min<std::int64_t>(media::jobs_of(video.encoder.jobs), (frames + length - 1) / length));
}

/// The machine would run out of memory, and kill this process or another.
void check_memory(const media::Format& format, const VideoDef& video) {
    const std::uint64_t bytes = media::bytes_per_job(format, video);
    if (media::jobs_that_fit(1, bytes) == 1) return;
    const bool can_be_faster =
        format.codec->origin == media::EncoderOrigin::kX264 && format.preset_of(video.encoder) != "ultrafast";
    const char* const faster = can_be_faster ? "a faster preset (--preset ultrafast), " : "";
    throw Error(
        ExitCode::kTemporary,
        fmt::format(
            "{} of {}x{} pixels takes some {:.1f} GiB of memory, and {:.1f} are free; choose a smaller "
            "size, {}or a machine with more",
            format.words(), video.width_px, video.height_px, static_cast<double>(bytes) / kGib,
            static_cast<double>(available_memory_bytes().value_or(0)) / kGib, faster));
}

/// Counts an empty frame.
void note_empty(double time_s, Rendered& result) {
    if (result.empty_frames++ == 0) result.first_empty_s = time_s;
}

/// Draws and encodes frames first <= k < end, skipping those the writer already holds; counts the empty
/// frames among all of them.
void write_frames(Film& film, std::int64_t first, std::int64_t end, const OnProgress& on_progress,
                  media::VideoWriter& writer, Rendered& result) {
    const VideoDef& video = film.scene().video;
    std::int64_t k = first;
    for (; k < first + writer.frames(); ++k) {
        report_progress(on_progress, writer.frames(), end - first);
        if (FilmRenderer::is_empty(film, film.time_s(k))) note_empty(film.time_s(k), result);
    }
    const int wanted = jobs_for(video, writer.frames_per_chunk(), end - k);
    if (wanted > 1 && FilmRenderer::can_draw_in_any_order(film, end)) {
        const int jobs = media::jobs_that_fit(wanted, media::bytes_per_job(writer.format(), video));
        result.is_short_of_memory = jobs < wanted;
        result.jobs = std::max(1, jobs);
    }
    if (result.jobs > 1 &&
        pipeline::render_chunks(film, first, end, result.jobs, on_progress, writer, result))
        return;
    result.jobs = 1;
    FilmRenderer renderer(film);
    const OnProgress ask = [&](std::int64_t, std::int64_t) {
        return !on_progress || on_progress(k - first, end - first);
    };
    for (; k < end; ++k) {
        report_progress(on_progress, k - first, end - first);
        const Damage damage = renderer.draw(film.time_s(k), ask);
        if (renderer.shows_nothing()) note_empty(film.time_s(k), result);
        writer.write(renderer.image(), damage, k + 1 == end);
    }
    report_progress(on_progress, end - first, end - first);
}

/// A transparent ground would become black without a word.
void check_ground(const Scene& scene, const media::Format& format) {
    const Ground ground = view::look_of(scene.style).ground;
    if (ground.is_opaque() || format.has_alpha) return;
    const Color clear = ground.top.a < 255 ? ground.top : ground.bottom;
    const bool has_other = media::can_be_transparent(*format.ending);
    throw Error(
        ExitCode::kUsage,
        fmt::format("style.background: \"{}\" is transparent, and {} cannot be; give an opaque colour "
                    "(--set style.background=#ffffff), {}",
                    clear.text(), format.words(),
                    has_other ? "or leave out video.codec and video.pix, as another encoder can"
                              : "draw stills as .png, or a video as " + media::endings_with_alpha()));
}

}  // namespace

namespace {

/// Returns what a render makes.
media::Format checked_format(const Scene& scene, const std::string& path, const RenderDef& def,
                             const std::string& input) {
    pipeline::validate(scene, {});
    const std::int64_t count = scene.video.fps.frame_count(scene.world.duration_s);
    const std::int64_t end = def.end.value_or(count);
    if (def.first < 0 || def.first >= end || end > count) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("frames {}:{} are not FIRST:END with 0 <= FIRST < END <= {} (END is not drawn)",
                        def.first, end, count));
    }
    const media::Format format =
        media::check_video_output(path, scene.video, input, def.force,
                                  !view::look_of(scene.style).ground.is_opaque(), def.first, end, def.resume);
    check_ground(scene, format);
    check_memory(format, scene.video);
    std::error_code none;
    const auto part_bytes = def.resume ? std::filesystem::file_size(part_path(path), none) : 0;
    media::check_disk_space(format, path, scene.video, end - def.first, none ? 0 : part_bytes);
    if (def.resume)
        check_part(path, origin_of(scene, format, def.first, end), [&](std::int64_t, std::int64_t) {
            return !def.on_progress || def.on_progress(0, end - def.first);
        });
    return format;
}

media::VideoWriter make_writer(Film& film, const std::string& path, const media::Format& format,
                               const RenderDef& def, std::int64_t end) {
    const OutputOptions options{.force = def.force, .on_progress = def.on_progress};
    const VideoDef& video = film.scene().video;
    media::VideoMetadata data =
        metadata(film, def.first, end, origin_of(film.scene(), format, def.first, end));
    if (def.resume) return media::VideoWriter::resume(path, video, std::move(data), options, def.first, end);
    return {path, video, std::move(data), options, def.first, end};
}

}  // namespace

void check_render(const Scene& scene, const std::string& path, const RenderDef& def,
                  const std::string& input) {
    const media::Format format = checked_format(scene, path, def, input);
    const OnProgress waiting = [&](std::int64_t, std::int64_t) {
        return !def.on_progress || def.on_progress(0, scene.video.fps.frame_count(scene.world.duration_s));
    };
    media::check_encoder_starts(format, scene.video, waiting);
}

Rendered render_video(Film& film, const std::string& path, const RenderDef& given) {
    RenderDef def = given;
    def.on_progress = FilmRenderer::guarded(film, given.on_progress);
    const media::Format format = checked_format(film.scene(), path, def, {});
    const std::int64_t end = def.end.value_or(film.frame_count());
    static_cast<void>(film.camera());  // what can fail does so before a file is made
    static_cast<void>(film.gl());
    const OnProgress waiting = [&def, all = media::passes(*format.ending) * (end - def.first)](std::int64_t,
                                                                                               std::int64_t) {
        return !def.on_progress || def.on_progress(0, all);
    };
    media::check_encoder_starts(format, film.scene().video, waiting);
    media::VideoWriter writer = make_writer(film, path, format, def, end);
    const OnProgress drawn = [&def, passes = media::passes(*format.ending)](std::int64_t k,
                                                                            std::int64_t all) {
        return !def.on_progress || def.on_progress(k, passes * all);
    };
    Rendered result;
    result.resumed_frames = writer.frames();
    result.was_part_damaged = writer.was_part_damaged();
    result.encoder = writer.format().encoder_name();
    try {
        write_frames(film, def.first, end, drawn, writer, result);
        writer.finish(def.verify_all ? media::VerifyDepth::kAllFrames : media::VerifyDepth::kKeyFrames);
    } catch (const ReaderLeft&) {
        result.reader_left = true;
    } catch (const Error& error) {
        if (error.code() == ExitCode::kDiverged) keep_diverged(error, path, def.first, writer);
        if (!is_interruption(error.code())) throw;
        result.complete = false;
        result.kept_part = writer.abandon(for_a_moment());
    }
    result.frames = writer.frames();
    return result;
}

}  // namespace corda
