#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/join.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/encode/probe.hpp"
#include "corda/media/encode/resources.hpp"
#include "corda/media/verify/verify.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/pipeline/motion_input.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/pipeline/provenance.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/view/colors.hpp"

namespace corda {
namespace {

constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

bool is_opaque(const Scene& scene) {
    return view::look_of(scene.style).ground.is_opaque();
}

/// Everything that determines the bytes of a video, by key.
std::map<std::string, std::string> origin_of(const Scene& scene, const media::Format& format,
                                             std::int64_t first, std::int64_t end) {
    std::map<std::string, std::string> origin = digest(scene);
    origin["corda"] = version();
    origin["encoder"] = format.encoder_name();
    origin["libraries"] = format.library_versions();
    origin["frames"] = fmt::format("{}:{}", first, end);
    return origin;
}

/// Refuses chunks of another render, and those that no process can read.
void check_chunks(const std::string& path, const std::map<std::string, std::string>& origin) {
    const std::string parts = media::parts_path(path);
    const auto manifest = media::read_manifest(parts);
    if (!manifest) return;
    if (const auto changes = differences(origin, manifest->made_from); !changes.empty())
        throw_usage(
            "'{}' is of another render: {}; make its chunks a video (corda recover), render to another name, "
            "or start again (--force without --resume)",
            parts, differences_text(changes));
    media::check_chunks_in_child(parts, *manifest);
}

/// Title, comment and provenance of the file.
media::VideoMetadata metadata(Film& film, std::int64_t first, std::int64_t end,
                              const std::map<std::string, std::string>& origin) {
    const Scene& scene = film.scene();
    Provenance made = provenance_of(scene);
    const std::string title = made.name;
    nlohmann::json comment = {{"corda", version()},
                              {"scene", title},
                              {"first_frame", first},
                              {"method", method_names(film.plan())},
                              {"error_estimate_m", or_null(film.plan().error_estimate_m)},
                              {"error_estimate_px", or_null(film.error_estimate_px())},
                              {"horizon_s", or_null(film.plan().horizon_s)}};
    // Without the range of frames, so that a picture has the bytes of the still.
    const std::string of_picture = provenance_text(made);
    made.frames = fmt::format("{}:{}", first, end);
    const std::string provenance = provenance_text(std::move(made));
    comment[kProvenanceKey] = nlohmann::json::parse(provenance);
    return {title, comment.dump(), !is_opaque(scene),
            [name = scene.name, rate = scene.video.scene_rate(), of_picture](std::int64_t frame) {
                return picture_info(name, fmt::format("{}", rate.time_s(frame)), std::to_string(frame),
                                    of_picture);
            },
            origin};
}

/// Refuses a video for which memory does not suffice, before the system kills a process.
void check_memory(const media::Format& format, const VideoDef& video) {
    const std::uint64_t bytes = media::bytes_per_job(format, video);
    if (media::jobs_that_fit(1, bytes) == 1) return;
    const bool can_be_faster =
        !format.codec->preset_job_bytes.empty() && format.preset_of(video.encoder) != "ultrafast";
    const char* const faster = can_be_faster ? "a faster preset (--preset ultrafast), " : "";
    throw_error(ExitCode::kTemporary,
                "{} of {}x{} pixels takes some {:.1f} GiB of memory, and {:.1f} are free; choose a smaller "
                "size, {}or a machine with more",
                format.words(), video.width_px, video.height_px, static_cast<double>(bytes) / kGib,
                static_cast<double>(available_memory_bytes().value_or(0)) / kGib, faster);
}

/// Adds to the message of a divergence where the frames before it are.
[[noreturn]] void keep_diverged(const Error& error, const std::string& path, media::VideoWriter& writer) {
    const std::string kept = writer.abandon();
    if (kept.empty()) throw Error(error.code(), error.what());
    throw_error(error.code(), "{}; the {} frames before it are in {}; {} was not written", error.what(),
                writer.frames(), kept, path);
}

/// Counts an empty frame of a Rendered or a Made.
template <class Frames>
void note_empty(double time_s, Frames& frames) {
    if (frames.empty_frames++ == 0 || time_s < frames.first_empty_s) frames.first_empty_s = time_s;
}

/// A chunk from a worker thread.
struct Made {
    media::Chunk chunk;
    std::int64_t empty_frames = 0;
    double first_empty_s = 0.0;
};

/// Encodes the frames first <= k < end, which `draw` draws with `renderer`, as one chunk.
template <class Renderer, class Draw>
media::Chunk draw_chunk(std::int64_t first, std::int64_t end, media::ChunkEncoder encoder,
                        const Renderer& renderer, const Draw& draw) {
    for (std::int64_t k = first; k < end; ++k) {
        check_cancelled();
        const Damage damage = draw(k);
        encoder.encode(renderer.image(), damage, k + 1 == end);
    }
    return encoder.finish();
}

/// Draws and encodes a chunk. Counts each frame in `drawn`. Throws corda::Error (kInterrupted) if all threads
/// are stopped.
Made make_chunk(std::int64_t chunk, const OrderedWorkers<Made>& all, const Film& film,
                const media::VideoWriter& writer, FilmRenderer& renderer, std::atomic<std::int64_t>& drawn) {
    Made made;
    const CancelScope running([&all] { return !all.is_stopped(); });
    const std::int64_t first = writer.manifest().first_of(chunk);
    made.chunk = draw_chunk(first, writer.manifest().end_of(chunk), writer.chunk_encoder(first), renderer,
                            [&](std::int64_t k) {
                                Damage damage = renderer.draw(film.time_s(k));
                                if (renderer.shows_nothing()) note_empty(film.time_s(k), made);
                                ++drawn;
                                return damage;
                            });
    return made;
}

void add(Made made, media::VideoWriter& writer, Rendered& result) {
    if (made.empty_frames > 0 && result.empty_frames == 0) result.first_empty_s = made.first_empty_s;
    result.empty_frames += made.empty_frames;
    writer.append(std::move(made.chunk));
}

/// Draws and encodes the chunks that a writer lacks, several at a time, each in a thread of its own. They
/// have the bytes that FilmRenderer and VideoWriter::write() give. Counts the empty frames in `result`.
///
/// Calls `on_progress` in this thread only, with the number of frames drawn. Requires
/// FilmRenderer::can_draw_in_any_order(film, end). Throws corda::Error: kEncoder, kNoGl, kIo, and
/// kInterrupted if on_progress asks to stop; then the writer has the whole chunks before the first one that
/// is not. Returns false, without any frame, if the system starts no thread.
bool render_chunks(Film& film, const std::vector<std::int64_t>& lacking, std::int64_t total,
                   const OnProgress& on_progress, media::VideoWriter& writer, Rendered& result) {
    const std::int64_t had = writer.frames();
    std::atomic<std::int64_t> drawn = 0;
    OrderedWorkers<Made> chunks(0, std::ssize(lacking), result.jobs, [&] {
        return [&, renderer = std::make_shared<FilmRenderer>(film)](std::int64_t index,
                                                                    const OrderedWorkers<Made>& all) {
            return make_chunk(lacking[static_cast<std::size_t>(index)], all, film, writer, *renderer, drawn);
        };
    });
    if (!chunks.has_threads()) return false;
    bool is_adding = false;
    try {
        while (chunks.taken() < std::ssize(lacking)) {
            if (auto made = chunks.wait()) {
                is_adding = true;
                add(std::move(*made), writer, result);
                is_adding = false;
            }
            report_progress(on_progress, had + drawn, total);
        }
        return true;
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        chunks.stop();
        for (bool goes_on = !is_adding; goes_on;) {  // a chunk that was added in part is the last one
            auto made = chunks.rest();
            goes_on = made.has_value();
            if (made) add(std::move(*made), writer, result);
        }
        throw;
    }
}

/// Draws and encodes the frames that the writer lacks. Counts all empty frames, of a shard its own.
void write_frames(Film& film, const media::CheckedVideo& video, const OnProgress& on_progress,
                  media::VideoWriter& writer, Rendered& result) {
    const std::vector<std::int64_t> lacking = writer.lacking_chunks();
    std::int64_t total = writer.frames();
    for (const std::int64_t chunk : lacking) total += writer.manifest().frames_of(chunk);
    const int wanted =
        static_cast<int>(std::min<std::int64_t>(media::jobs_of(video.def.encoder.jobs), std::ssize(lacking)));
    if (wanted > 1 && FilmRenderer::can_draw_in_any_order(film, video.end)) {
        const int jobs = media::jobs_that_fit(wanted, media::bytes_per_job(writer.format(), video.def));
        result.is_short_of_memory = jobs < wanted;
        result.jobs = std::max(1, jobs);
    }
    const bool is_made = result.jobs > 1 && render_chunks(film, lacking, total, on_progress, writer, result);
    if (!is_made) result.jobs = 1;
    std::int64_t done = is_made ? total : writer.frames();
    std::optional<FilmRenderer> renderer;
    const CancelScope progress([&] { report_progress(on_progress, done, total); });
    for (std::int64_t k = video.first; k < video.end; ++k) {
        check_cancelled();
        const bool is_lacking = std::ranges::binary_search(lacking, k / writer.manifest().per_chunk);
        const double time_s = film.time_s(k);
        if (!is_lacking && !video.shard && FilmRenderer::is_empty(film, time_s)) note_empty(time_s, result);
        if (!is_lacking || is_made) continue;
        if (!renderer) renderer.emplace(film);
        const Damage damage = renderer->draw(time_s);
        if (renderer->shows_nothing()) note_empty(time_s, result);
        writer.write(renderer->image(), damage);
        ++done;
    }
    check_cancelled();
    result.chunks = std::ssize(lacking);
}

/// Refuses a transparent ground in a format without alpha, which would show it black.
void check_ground(const Scene& scene, const media::Format& format) {
    const Ground ground = view::look_of(scene.style).ground;
    if (ground.is_opaque() || format.has_alpha) return;
    const Color clear = ground.top.a < 255 ? ground.top : ground.bottom;
    const bool has_other = media::can_be_transparent(*format.ending);
    throw_usage(
        "style.background: \"{}\" is transparent, and {} cannot be; give an opaque colour (--set "
        "style.background=#ffffff), {}",
        clear.text(), format.words(),
        has_other ? "or leave out video.codec and video.pix, as another encoder can"
                  : "draw stills as .png, or a video as " + media::endings_with_alpha());
}

/// The output of frames first <= k < end with everything checked but the encoder's start.
media::CheckedVideo check_video(const Scene& scene, const std::string& path, const RenderDef& def,
                                const std::string& input, std::int64_t end) {
    media::CheckedVideo video = media::check_video_output({.path = path,
                                                           .def = scene.video,
                                                           .first = def.first,
                                                           .end = end,
                                                           .force = def.force,
                                                           .resume = def.resume,
                                                           .shard = def.shard},
                                                          input, !is_opaque(scene));
    check_ground(scene, video.format);
    check_memory(video.format, video.def);
    const bool continues = def.resume || def.shard;
    const std::uint64_t there = continues ? media::bytes_of(media::chunk_files(media::parts_path(path))) : 0;
    media::check_disk_space(video.format, path, video.def, end - def.first, there);
    if (continues) check_chunks(path, origin_of(scene, video.format, def.first, end));
    return video;
}

}  // namespace

CheckedOutput::CheckedOutput(media::CheckedVideo video, bool verify_all)
    : video_(std::make_shared<const media::CheckedVideo>(std::move(video))), verify_all_(verify_all) {}

const std::string& CheckedOutput::path() const {
    return video_->path;
}

std::int64_t CheckedOutput::first() const {
    return video_->first;
}

std::int64_t CheckedOutput::end() const {
    return video_->end;
}

CheckedOutput check_render(const Scene& scene, const std::string& path, const RenderDef& def,
                           const std::string& input) {
    pipeline::validate(scene, {});
    const std::int64_t count = scene.video.scene_rate().frame_count(scene.world.duration_s);
    const std::int64_t end = def.end.value_or(count);
    if (def.first < 0 || def.first >= end || end > count) {
        throw_usage("frames {}:{} are not FIRST:END with 0 <= FIRST < END <= {} (END is not drawn)",
                    def.first, end, count);
    }
    std::int64_t total = end - def.first;
    const CancelScope starting([&] { report_progress(def.on_progress, 0, total); });
    media::CheckedVideo video = check_video(scene, path, def, input, end);
    total *= media::passes(*video.format.ending);
    media::check_encoder_starts(video.format, video.def);
    return {std::move(video), def.verify_all};
}

Rendered render_video(Film& film, const CheckedOutput& output, const OnProgress& on_progress) {
    const media::CheckedVideo& video = output.video();
    const VideoDef& shown = film.scene().video;
    if (shown.width_px != video.def.width_px || shown.height_px != video.def.height_px ||
        shown.fps.rational() != video.def.fps.rational()) {
        throw_usage(
            "'{}' was checked for {}x{} at {} frames per second, and the film has {}x{} at {}; check the "
            "output with the scene of the film",
            video.path, video.def.width_px, video.def.height_px, video.def.fps.rational().text(),
            shown.width_px, shown.height_px, shown.fps.rational().text());
    }
    const pipeline::SharedMotion::Activity rendering(FilmRenderer::motion_of(film));
    const std::int64_t passes = media::passes(*video.format.ending);
    static_cast<void>(film.camera());  // may fail, which is to happen before a file is made
    static_cast<void>(film.gl());
    std::optional<CancelScope> resuming(
        std::in_place, [&] { report_progress(on_progress, 0, passes * (video.end - video.first)); });
    media::VideoMetadata data =
        metadata(film, video.first, video.end, origin_of(film.scene(), video.format, video.first, video.end));
    const nlohmann::json comment = nlohmann::json::parse(data.comment_json);
    media::VideoWriter writer(video, std::move(data));
    resuming.reset();
    const OnProgress drawn = [&on_progress, passes](std::int64_t k, std::int64_t all) {
        return !on_progress || on_progress(k, passes * all);
    };
    Rendered result;
    result.resumed_frames = writer.frames();
    result.damaged_chunks = writer.damaged_chunks();
    result.encoder = video.format.encoder_name();
    const media::FileKind kind = video.format.ending->kind;
    if (kind == media::FileKind::kVideo || kind == media::FileKind::kPictures)
        result.left_out = left_out_of(comment[kProvenanceKey].dump());
    try {
        write_frames(film, video, drawn, writer, result);
        writer.finish(output.verifies_all() ? media::VerifyDepth::kAllFrames : media::VerifyDepth::kKeyFrames,
                      on_progress);
    } catch (const ReaderLeft&) {
        result.reader_left = true;
    } catch (const Error& error) {
        if (error.code() == ExitCode::kDiverged) keep_diverged(error, video.path, writer);
        if (!is_interruption(error.code())) throw;
        result.complete = false;
        result.kept = writer.abandon();
    }
    result.frames = writer.frames();
    return result;
}

std::vector<std::string> video_files(Film& film, FilmRenderer& renderer, const std::string& name) {
    const VideoDef& def = film.scene().video;
    const media::CheckedVideo video{.path = name,
                                    .def = def,
                                    .format = media::find_format(name, def, !is_opaque(film.scene())),
                                    .end = film.frame_count()};
    check_ground(film.scene(), video.format);
    const media::VideoMetadata data = metadata(film, 0, video.end, {});
    const std::int64_t per_chunk = media::frames_per_chunk(video.format, def.fps);
    std::vector<media::Chunk> chunks;
    for (std::int64_t first = 0; first < video.end; first += per_chunk) {
        const std::int64_t end = std::min(first + per_chunk, video.end);
        media::ChunkEncoder encoder(media::make_encoder(video.format, def, first, data.picture_info), first);
        chunks.push_back(draw_chunk(first, end, std::move(encoder), renderer,
                                    [&](std::int64_t k) { return renderer.draw(film.time_s(k)); }));
    }
    return media::video_files(video, data, chunks);
}

Rendered render_video(Film& film, const std::string& path, const RenderDef& def) {
    return render_video(film, check_render(film.scene(), path, def), def.on_progress);
}

}  // namespace corda
