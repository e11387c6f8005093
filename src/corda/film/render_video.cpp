#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/provenance.hpp"
#include "corda/media/encode/frame_maker.hpp"
#include "corda/media/encode/probe.hpp"
#include "corda/media/write/video_file.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/view/colors.hpp"

namespace corda {
namespace {

/// Why a picture with this record is not of this scene.
std::string difference_text(const Scene& scene, const Provenance& made) {
    if (made.corda.empty()) return "it has no record of its scene";
    if (made.corda != version())
        return fmt::format("corda {} made it, and this is {}", made.corda, version());
    if (scene.given)
        return "it is of another frame or scene, or of other positions";  // it keeps a hash alone
    try {
        const auto changes = differences(values_of(scene), values_of(scene_of(made, "it")));
        if (!changes.empty()) return changes_text(changes);
    } catch (const Error&) {
        // Its scene cannot be read, or is left out.
    }
    return "it is of another frame, or of another file with this scene";
}

bool is_opaque(const Scene& scene) {
    return view::theme_colors(scene.style).ground.is_opaque();
}

/// What each picture of a sequence says, without the range of frames: it has the bytes of the still.
media::PictureInfo picture_info_of(const Scene& scene) {
    return [name = scene.name, rate = scene.video.scene_rate(),
            provenance = provenance_text(provenance_of(scene))](std::int64_t frame) {
        return picture_info(name, fmt::format("{}", rate.time_s(frame)), std::to_string(frame), provenance);
    };
}

/// Title, comment and provenance of the file.
media::VideoMetadata metadata(const Film& film, std::int64_t first, std::int64_t end) {
    Provenance made = provenance_of(film.scene());
    const std::string title = made.name;
    nlohmann::json comment = {{"corda", version()},
                              {"scene", title},
                              {"first_frame", first},
                              {"method", method_names(film.plan())},
                              {"error_estimate_m", or_null(film.plan().error_estimate_m)},
                              {"error_estimate_px", or_null(film.error_estimate_px())},
                              {"horizon_s", or_null(film.plan().horizon_s)}};
    made.frames = fmt::format("{}:{}", first, end);
    comment[kProvenanceKey] = nlohmann::json::parse(provenance_text(std::move(made)));
    return {title, comment.dump()};
}

/// Counts an empty frame.
void note_empty(double time_s, Rendered& result) {
    if (result.empty_frames++ == 0 || time_s < result.first_empty_s) result.first_empty_s = time_s;
}

struct Drawn {
    media::ReadyFrame frame;
    bool is_empty = false;
};

/// Draws frames of a film on the thread that made it, ready for a VideoFile.
class FrameDrawer {
  public:
    FrameDrawer(const Film& film, const media::CheckedVideo& video)
        : film_(film),
          last_(video.end - 1),
          canvas_(film.context_def()),
          maker_(video.format, video.first, picture_info_of(film.scene())) {}

    Drawn draw(std::int64_t k) {
        check_cancelled();
        if (k > last_ && shows_last_) return {maker_.make(k, canvas_->image(), Damage{}), is_last_empty_};
        const double time_s = film_.time_s(std::min(k, last_));
        const auto [damage, is_empty] =
            film::paint(film_.look(), film_.motion(), time_s, film_.scene().video.shutter, *canvas_);
        shows_last_ = k >= last_;
        is_last_empty_ = is_empty;
        return {maker_.make(k, canvas_->image(), damage), is_empty};
    }

  private:
    const Film& film_;
    std::int64_t last_;  ///< the frame that later ones repeat
    bool shows_last_ = false;
    bool is_last_empty_ = false;
    render::CanvasUse canvas_;
    media::FrameMaker maker_;
};

using Block = std::vector<Drawn>;

/// Frames that a thread draws one after the other: as many as keep all that are drawn ahead in a bounded
/// memory. The first of a block costs more: its thread draws all that changed since its last block, and the
/// encoder compares the whole picture. No byte depends on it.
std::int64_t block_length(const VideoDef& video, int jobs) {
    constexpr std::int64_t kMaxFrames = 8;
    constexpr std::int64_t kMaxBytes = 128 << 20;
    const std::int64_t ahead = std::int64_t{8} * jobs * video.width_px * video.height_px;
    return std::clamp<std::int64_t>(kMaxBytes / ahead, 1, kMaxFrames);
}

/// Draws the frames of a video on `jobs` threads, each a block of consecutive frames at a time, and calls
/// `take` on this thread with one after the other, in order. Returns false, without any frame, if the system
/// starts no thread.
bool draw_on_threads(const Film& film, const media::CheckedVideo& video, int jobs,
                     std::atomic<std::int64_t>& drawn, const std::function<void(Drawn)>& take) {
    const std::vector<std::int64_t>& frames = video.to_draw;
    const std::int64_t length = block_length(video.def, jobs);
    const std::int64_t blocks = (std::ssize(frames) + length - 1) / length;
    const auto new_maker = [&] {
        return [&, drawer = std::make_shared<FrameDrawer>(film, video)](std::int64_t number,
                                                                        const OrderedWorkers<Block>& all) {
            const CancelScope running([&all] { return !all.is_stopped(); });
            Block block;
            const std::int64_t end = std::min((number + 1) * length, std::ssize(frames));
            for (std::int64_t i = number * length; i < end; ++i, ++drawn)
                block.push_back(drawer->draw(frames[static_cast<std::size_t>(i)]));
            return block;
        };
    };
    OrderedWorkers<Block> workers(0, blocks, jobs, new_maker);
    if (!workers.has_threads()) return false;
    while (workers.taken() < blocks) {
        if (auto block = workers.wait())
            for (Drawn& one : *block) take(std::move(one));
        check_cancelled();
    }
    return true;
}

/// Draws the frames of a video and adds them to its file. Counts them in `result`, and the empty ones.
void write_frames(const Film& film, const media::CheckedVideo& video, const OnProgress& on_progress,
                  media::VideoFile& file, Rendered& result) {
    const std::int64_t total = media::passes(*video.format.ending) * video.frames();
    std::atomic<std::int64_t> drawn = result.kept_frames;
    const CancelScope progress([&] { report_progress(on_progress, drawn, total); });
    const auto take = [&](Drawn one) {
        check_cancelled();
        if (one.is_empty) note_empty(film.time_s(std::min(one.frame.number, video.end - 1)), result);
        file.add(std::move(one.frame));
        ++result.frames;
    };
    const auto jobs =
        static_cast<int>(std::min<std::int64_t>(jobs_of(video.def.encoder.jobs), std::ssize(video.to_draw)));
    if (jobs > 1 && draw_on_threads(film, video, jobs, drawn, take)) return;
    std::optional<FrameDrawer> drawer;
    for (const std::int64_t k : video.to_draw) {
        if (!drawer) drawer.emplace(film, video);
        take(drawer->draw(k));
        ++drawn;
    }
}

/// How often the last of a film's frames is repeated in an output that ends with it.
std::int64_t held_frames(const VideoDef& def, const media::Format& format) {
    return format.ending->kind == media::FileKind::kPictures ? 0 : def.held_frames();
}

/// Refuses a transparent ground in a format without alpha, which would show it black.
void check_ground(const Scene& scene, const media::Format& format) {
    const Ground ground = view::theme_colors(scene.style).ground;
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

/// Counts the pictures that were there, and those of them that are empty.
void count_kept(const Film& film, const media::CheckedVideo& video, Rendered& result) {
    result.kept_frames = video.frames() - std::ssize(video.to_draw);
    result.frames = result.kept_frames;
    if (result.kept_frames == 0) return;
    for (std::int64_t k = video.first; k < video.end; ++k) {
        const double time_s = film.time_s(k);
        if (!std::ranges::binary_search(video.to_draw, k) &&
            film.is_empty(time_s, film.scene().video.shutter))
            note_empty(time_s, result);
    }
}

}  // namespace

CheckedOutput::CheckedOutput(media::CheckedVideo video)
    : video_(std::make_shared<const media::CheckedVideo>(std::move(video))) {}

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
    film::validate(scene, {});
    const std::int64_t count = scene.video.scene_rate().frame_count(scene.world.duration_s);
    const std::int64_t end = def.end.value_or(count);
    if (def.first < 0 || def.first >= end || end > count) {
        throw_usage("frames {}:{} are not FIRST:END with 0 <= FIRST < END <= {} (END is not drawn)",
                    def.first, end, count);
    }
    media::CheckedVideo video = media::check_video_output({.path = path,
                                                           .def = scene.video,
                                                           .first = def.first,
                                                           .end = end,
                                                           .force = def.force,
                                                           .resume = def.resume},
                                                          input, !is_opaque(scene));
    if (end == count) video.held = held_frames(scene.video, video.format);
    check_ground(scene, video.format);
    media::check_threads(*video.format.codec);
    video.to_draw = media::frames_to_draw(video, picture_info_of(scene), [&](const PngInfo& found) {
        return difference_text(scene, provenance_in(found));
    });
    return CheckedOutput(std::move(video));
}

Rendered render_video(const Film& film, const CheckedOutput& output, const OnProgress& on_progress) {
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
    static_cast<void>(film.gl());  // may fail, which is to happen before a file is made
    media::VideoMetadata data = metadata(film, video.first, video.end);
    Rendered result;
    result.encoder = video.format.codec->name;
    const media::FileKind kind = video.format.ending->kind;
    if (kind == media::FileKind::kVideo || kind == media::FileKind::kPictures)
        result.left_out = left_out_of(nlohmann::json::parse(data.comment_json)[kProvenanceKey].dump());
    try {
        media::VideoFile file(video, std::move(data));
        count_kept(film, video, result);
        write_frames(film, video, on_progress, file, result);
        file.commit(on_progress);
    } catch (const ReaderLeft&) {
        result.reader_left = true;
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        result.complete = false;
        const bool is_one_file = kind == media::FileKind::kVideo || kind == media::FileKind::kAnimation;
        if (is_one_file) result.frames = 0;
    }
    return result;
}

std::vector<std::string> video_files(const Film& film, const std::string& name) {
    const VideoDef& def = film.scene().video;
    media::CheckedVideo video{.path = name,
                              .def = def,
                              .format = media::find_format(name, def, !is_opaque(film.scene())),
                              .end = film.frame_count()};
    video.held = held_frames(def, video.format);
    check_ground(film.scene(), video.format);
    std::vector<std::string> files;
    OutputFile output{OutputFile::InMemory()};
    std::optional<media::TrackWriter> track;
    if (video.format.ending->kind == media::FileKind::kVideo)
        track.emplace(video, metadata(film, 0, video.end), output);
    FrameDrawer drawer(film, video);
    for (std::int64_t k = 0; k < video.frames(); ++k) {
        media::ReadyFrame frame = drawer.draw(k).frame;
        if (track)
            track->add(std::move(frame));
        else
            files.push_back(std::move(frame.file));
    }
    if (!track) return files;
    track->finish();
    return {output.bytes()};
}

Rendered render_video(const Film& film, const std::string& path, const RenderDef& def) {
    return render_video(film, check_render(film.scene(), path, def), def.on_progress);
}

}  // namespace corda
