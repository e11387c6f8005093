#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/media/encode/probe.hpp"
#include "corda/media/encode/resources.hpp"
#include "corda/media/read/video_comment.hpp"
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

/// Refuses to resume a part of another render, or a file that is not a part.
void check_part(const std::string& path, const std::map<std::string, std::string>& origin) {
    const std::string part = part_path(path);
    std::error_code ignored;
    const auto bytes = std::filesystem::file_size(part, ignored);
    if (ignored || bytes == 0) return;
    const auto fail = [&](const std::string& problem, const char* other = "make it a video (corda recover)") {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' {}, so --resume cannot continue it; {}, render to another name, or start "
                        "again (--force without --resume)",
                        part, problem, other));
    };
    media::check_part_in_child(part, false);
    const media::PartComment comment = media::part_comment(part);
    if (comment.is_damaged) fail("is damaged in its first chunk", "move it away");
    if (!comment.text) {
        // A part of this render that was interrupted in its first chunk has no frames to lose.
        const std::string marker = fmt::format("\"{}\":{}", media::kOriginKey, nlohmann::json(origin).dump());
        if (media::holds_in_front(part, marker)) return;
        fail("holds no whole chunk of this render", "move it away");
    }
    const std::map<std::string, std::string> its = media::told_origin(*comment.text);
    if (its.empty()) fail("does not record what it was rendered from");
    if (const auto changes = differences(origin, its); !changes.empty())
        fail("is of another render: " + differences_text(changes));
}

/// Title, comment and provenance of the file.
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
    // Without the range of frames, so that a picture has the bytes of the still.
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

/// Keeps the frames before a divergence, and adds their file to the message.
[[noreturn]] void keep_diverged(const Error& error, const std::string& path, std::int64_t first,
                                media::VideoWriter& writer) {
    const std::string kept = writer.abandon();
    const std::int64_t frames = writer.frames();
    if (frames == 0) throw Error(error.code(), error.what());
    throw Error(error.code(),
                fmt::format("{}; frames {}..{} before it are in {}, which plays; {} was not written",
                            error.what(), first, first + frames - 1, kept, path));
}

/// Number of chunks to make at a time: at most one per chunk of `length` frames.
int jobs_for(const VideoDef& video, std::int64_t length, std::int64_t frames) {
    return static_cast<int>(
        std::min<std::int64_t>(media::jobs_of(video.encoder.jobs), (frames + length - 1) / length));
}

/// Refuses a video for which memory does not suffice, before the system kills a process.
void check_memory(const media::Format& format, const VideoDef& video) {
    const std::uint64_t bytes = media::bytes_per_job(format, video);
    if (media::jobs_that_fit(1, bytes) == 1) return;
    const bool can_be_faster =
        !format.codec->preset_job_bytes.empty() && format.preset_of(video.encoder) != "ultrafast";
    const char* const faster = can_be_faster ? "a faster preset (--preset ultrafast), " : "";
    throw Error(
        ExitCode::kTemporary,
        fmt::format(
            "{} of {}x{} pixels takes some {:.1f} GiB of memory, and {:.1f} are free; choose a smaller "
            "size, {}or a machine with more",
            format.words(), video.width_px, video.height_px, static_cast<double>(bytes) / kGib,
            static_cast<double>(available_memory_bytes().value_or(0)) / kGib, faster));
}

/// Counts an empty frame of a Rendered or a Made.
template <class Frames>
void note_empty(double time_s, Frames& frames) {
    if (frames.empty_frames++ == 0) frames.first_empty_s = time_s;
}

/// A chunk from a worker thread.
struct Made {
    media::Chunk chunk;
    std::int64_t empty_frames = 0;
    double first_empty_s = 0.0;
    bool is_whole = true;
};

/// Makes the chunks of frames from <= k < end of a film.
class ChunkMaker {
  public:
    ChunkMaker(Film& film, const media::VideoWriter& writer, std::int64_t from, std::int64_t end)
        : film_(&film), writer_(&writer), from_(from), end_(end), length_(writer.frames_per_chunk()) {}

    [[nodiscard]] std::int64_t first_chunk() const { return from_ / length_; }
    [[nodiscard]] std::int64_t end_chunk() const { return (end_ + length_ - 1) / length_; }
    /// Number of frames drawn so far.
    [[nodiscard]] std::int64_t drawn() const { return drawn_; }

    /// The function that makes chunks in one thread, with a renderer of its own.
    [[nodiscard]] OrderedWorkers<Made>::Make maker() {
        const auto renderer = std::make_shared<FilmRenderer>(*film_);
        return [this, renderer](std::int64_t number, const OrderedWorkers<Made>& all) {
            return make(number, all, *renderer);
        };
    }

  private:
    /// Makes a chunk, or as much of it as is drawn when all threads are stopped.
    Made make(std::int64_t number, const OrderedWorkers<Made>& all, FilmRenderer& renderer) {
        Made made;
        const CancelScope running([&all] { return !all.is_stopped(); });
        const std::int64_t first = std::max(from_, number * length_);
        const std::int64_t end = std::min(end_, (number + 1) * length_);
        media::ChunkEncoder encoder = writer_->chunk_encoder(first);
        for (std::int64_t k = first; k < end && !all.is_stopped(); ++k) {
            const double time_s = film_->time_s(k);
            try {
                const Damage damage = renderer.draw(time_s);
                if (renderer.shows_nothing()) note_empty(time_s, made);
                encoder.encode(renderer.image(), damage, k + 1 == end);
            } catch (const Error& error) {
                if (error.code() != ExitCode::kInterrupted || !all.is_stopped()) throw;
                break;
            }
            ++drawn_;
        }
        made.is_whole = encoder.frames() == end - first;
        // If it is incomplete, only the next chunk to write is kept.
        if (made.is_whole || number == all.taken()) finish(encoder, all, made);
        return made;
    }

    /// Flushes the encoder; once all threads are stopped, only for a moment.
    static void finish(media::ChunkEncoder& encoder, const OrderedWorkers<Made>& all, Made& made) {
        std::optional<double> end_s;
        try {
            made.chunk = encoder.finish([&] {
                if (all.is_stopped() && !end_s) end_s = now_s() + media::kMomentS;
                return !end_s || now_s() < *end_s;
            });
        } catch (const Error& error) {
            if (error.code() != ExitCode::kInterrupted) throw;
            made.is_whole = false;
        }
    }

    Film* film_;
    const media::VideoWriter* writer_;
    std::int64_t from_;
    std::int64_t end_;
    std::int64_t length_;
    std::atomic<std::int64_t> drawn_ = 0;
};

void add(Made made, media::VideoWriter& writer, Rendered& result) {
    if (made.chunk.frames == 0) return;  // dropped because it was incomplete
    if (made.empty_frames > 0 && result.empty_frames == 0) result.first_empty_s = made.first_empty_s;
    result.empty_frames += made.empty_frames;
    writer.append(std::move(made.chunk));
}

/// Draws and encodes the frames from the end of the writer's up to `end`, in chunks, several at a time, each
/// in a thread of its own. `from` is the number in the film of the writer's first frame. The frames have the
/// bytes that FilmRenderer and VideoWriter::write() give. Counts the empty ones in `result`.
///
/// Calls `on_progress` in this thread only, with the number of frames drawn. Requires
/// FilmRenderer::can_draw_in_any_order(film, end). Throws corda::Error: kEncoder, kNoGl, kIo, and
/// kInterrupted if on_progress asks to stop; then the writer has the frames before the first one that was not
/// drawn. Returns false, without any frame, if the system starts no thread.
bool render_chunks(Film& film, std::int64_t from, std::int64_t end, int jobs, const OnProgress& on_progress,
                   media::VideoWriter& writer, Rendered& result) {
    const std::int64_t had = writer.frames();
    ChunkMaker maker(film, writer, from + had, end);
    OrderedWorkers<Made> chunks(maker.first_chunk(), maker.end_chunk(), jobs,
                                [&maker] { return maker.maker(); });
    if (!chunks.has_threads()) return false;
    bool is_adding = false;
    try {
        while (writer.frames() < end - from) {
            if (auto made = chunks.wait()) {
                is_adding = true;
                add(std::move(*made), writer, result);
                is_adding = false;
            }
            report_progress(on_progress, had + maker.drawn(), end - from);
        }
        return true;
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        chunks.stop();
        bool is_whole = !is_adding;  // an incomplete chunk is the last one
        while (is_whole) {
            auto made = chunks.rest();
            is_whole = made && made->is_whole;
            if (made) add(std::move(*made), writer, result);
        }
        throw;
    }
}

/// Draws and encodes frames first <= k < end that the writer does not have yet; counts all empty frames.
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
    if (result.jobs > 1 && render_chunks(film, first, end, result.jobs, on_progress, writer, result)) return;
    result.jobs = 1;
    FilmRenderer renderer(film);
    const CancelScope progress([&] { report_progress(on_progress, k - first, end - first); });
    for (; k < end; ++k) {
        check_cancelled();
        const Damage damage = renderer.draw(film.time_s(k));
        if (renderer.shows_nothing()) note_empty(film.time_s(k), result);
        writer.write(renderer.image(), damage, k + 1 == end);
    }
    check_cancelled();
}

/// Refuses a transparent ground in a format without alpha, which would show it black.
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

/// The output of frames first <= k < end with everything checked but the encoder's start.
media::CheckedVideo check_video(const Scene& scene, const std::string& path, const RenderDef& def,
                                const std::string& input, std::int64_t end) {
    media::CheckedVideo video =
        media::check_video_output(path, scene.video, input, def.force,
                                  !view::look_of(scene.style).ground.is_opaque(), def.first, end, def.resume);
    check_ground(scene, video.format);
    check_memory(video.format, scene.video);
    std::error_code none;
    const auto part_bytes = def.resume ? std::filesystem::file_size(part_path(path), none) : 0;
    media::check_disk_space(video.format, path, scene.video, end - def.first, none ? 0 : part_bytes);
    if (def.resume) check_part(path, origin_of(scene, video.format, def.first, end));
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
    const std::int64_t count = scene.video.fps.frame_count(scene.world.duration_s);
    const std::int64_t end = def.end.value_or(count);
    if (def.first < 0 || def.first >= end || end > count) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("frames {}:{} are not FIRST:END with 0 <= FIRST < END <= {} (END is not drawn)",
                        def.first, end, count));
    }
    std::int64_t total = end - def.first;
    const CancelScope starting([&] { report_progress(def.on_progress, 0, total); });
    media::CheckedVideo video = check_video(scene, path, def, input, end);
    total *= media::passes(*video.format.ending);
    media::check_encoder_starts(video.format, scene.video);
    return {std::move(video), def.verify_all};
}

Rendered render_video(Film& film, const CheckedOutput& output, const OnProgress& on_progress) {
    const media::CheckedVideo& video = output.video();
    const VideoDef& shown = film.scene().video;
    if (shown.width_px != video.def.width_px || shown.height_px != video.def.height_px ||
        shown.fps.rational() != video.def.fps.rational()) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' was checked for {}x{} at {} frames per second, and the film has {}x{} "
                        "at {}; check the output with the scene of the film",
                        video.path, video.def.width_px, video.def.height_px, video.def.fps.rational().text(),
                        shown.width_px, shown.height_px, shown.fps.rational().text()));
    }
    const pipeline::SharedMotion::Activity rendering(FilmRenderer::motion_of(film));
    const std::int64_t passes = media::passes(*video.format.ending);
    static_cast<void>(film.camera());  // may fail, which is to happen before a file is made
    static_cast<void>(film.gl());
    std::optional<CancelScope> resuming(std::in_place, [&] {
        report_progress(on_progress, 0, passes * (video.end - video.first));
        return true;
    });
    media::VideoWriter writer(video, metadata(film, video.first, video.end,
                                              origin_of(film.scene(), video.format, video.first, video.end)));
    resuming.reset();
    const OnProgress drawn = [&on_progress, passes](std::int64_t k, std::int64_t all) {
        return !on_progress || on_progress(k, passes * all);
    };
    Rendered result;
    result.resumed_frames = writer.frames();
    result.was_part_damaged = writer.was_part_damaged();
    result.encoder = video.format.encoder_name();
    try {
        write_frames(film, video.first, video.end, drawn, writer, result);
        writer.finish(output.verifies_all() ? media::VerifyDepth::kAllFrames : media::VerifyDepth::kKeyFrames,
                      on_progress);
    } catch (const ReaderLeft&) {
        result.reader_left = true;
    } catch (const Error& error) {
        if (error.code() == ExitCode::kDiverged) keep_diverged(error, video.path, video.first, writer);
        if (!is_interruption(error.code())) throw;
        result.complete = false;
        result.kept_part = writer.abandon();
    }
    result.frames = writer.frames();
    return result;
}

Rendered render_video(Film& film, const std::string& path, const RenderDef& def) {
    return render_video(film, check_render(film.scene(), path, def), def.on_progress);
}

}  // namespace corda
