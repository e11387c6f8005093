#include "benchmark/video/measure.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "benchmark/video/baseline_encoder.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/frame_maker.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/write/video_file.hpp"
#include "support/yuv420_image.hpp"

namespace corda::benchmark {
namespace {

using nlohmann::json;

constexpr double kMib = 1024.0 * 1024.0;
/// Pictures in memory that the encoder alone is fed from.
constexpr double kMaxPictureBytes = 1024.0 * kMib;

double cpu_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// A line of /proc/self/status in MiB: VmRSS, or its peak, VmHWM.
double memory_mib(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (!line.starts_with(key + ":")) continue;
        std::istringstream words(line.substr(key.size() + 1));
        double kib = 0.0;
        words >> kib;
        return kib / 1024.0;
    }
    return 0.0;
}

/// From now on VmHWM is the peak.
void reset_peak_memory() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

/// Number of frames of each video.
std::int64_t frames_of(const BenchDef& def) {
    return std::min(def.frames, def.scene.video.fps.frame_count(def.scene.world.duration_s));
}

json render(const BenchDef& def, const std::string& path) {
    const double start_s = now_s();
    Film film(def.scene, def.film);
    RenderDef render;
    render.force = true;
    render.end = frames_of(def);
    static_cast<void>(render_video(film, path, render));
    return {{"wall_s", now_s() - start_s}, {"peak_rss_mib", memory_mib("VmHWM")}};
}

/// Draws the frames one after the other.
template <class Use>
void draw_frames(const Film& film, std::int64_t frames, const Use& use) {
    const render::CanvasUse canvas(film.context_def());
    for (std::int64_t k = 0; k < frames; ++k) {
        const Damage damage =
            film::paint(film.look(), film.motion(), film.time_s(k), film.scene().video.shutter, *canvas)
                .damage;
        use(canvas->image(), damage);
    }
}

/// Largest number of pictures in memory.
std::int64_t max_pictures(const VideoDef& video) {
    constexpr double kBytesPerPixel = 1.5;
    const double bytes = kBytesPerPixel * video.width_px * video.height_px;
    return std::max<std::int64_t>(2, static_cast<std::int64_t>(kMaxPictureBytes / bytes));
}

json encode_alone(const BenchDef& def) {
    const VideoDef& video = def.scene.video;
    BaselineEncoder encoder(video);
    {
        Film film(def.scene, def.film);
        draw_frames(film, std::min(frames_of(def), max_pictures(video)),
                    [&](const Image& picture, const Damage&) { encoder.add(picture); });
    }
    // What was freed must not serve the encoder, or its own memory would not show.
    malloc_trim(0);
    const double before_mib = memory_mib("VmRSS");
    reset_peak_memory();
    const std::int64_t few = std::min<std::int64_t>(frames_of(def), media::key_interval(video.fps));
    static_cast<void>(encoder.encode(few, 1));
    const double encoder_mib = memory_mib("VmHWM") - before_mib;
    const double start_s = now_s();
    static_cast<void>(encoder.encode(frames_of(def), usable_cores()));
    return {{"wall_s", now_s() - start_s}, {"encoder_rss_mib", encoder_mib}};
}

/// Times of parts of the work, in the order in which they are named first.
class StageClock {
  public:
    template <class Work>
    void measure(const char* name, const Work& work) {
        const double start_s = now_s();
        const double start_cpu_s = cpu_s();
        work();
        Stage& stage = find(name);
        stage.wall_s += now_s() - start_s;
        stage.cpu_s += cpu_s() - start_cpu_s;
    }
    [[nodiscard]] json to_json() const {
        json list = json::array();
        for (const Stage& stage : stages_)
            list.push_back({{"name", stage.name}, {"wall_s", stage.wall_s}, {"cpu_s", stage.cpu_s}});
        return list;
    }

  private:
    Stage& find(const std::string& name) {
        const auto is_it = [&name](const Stage& stage) { return stage.name == name; };
        const auto stage = std::find_if(stages_.begin(), stages_.end(), is_it);
        return stage != stages_.end() ? *stage : stages_.emplace_back(Stage{name});
    }

    std::vector<Stage> stages_;
};

/// The stages, each by itself, in one thread. Replaces the video at `path`.
json measure_stages(const BenchDef& def, const std::string& path) {
    const VideoDef& video = def.scene.video;
    const std::int64_t frames = frames_of(def);
    StageClock clock;
    std::optional<Film> film;
    clock.measure("simulate", [&] { film.emplace(def.scene, def.film); });
    clock.measure("open OpenGL", [&] { static_cast<void>(film->gl()); });
    clock.measure("draw", [&] { draw_frames(*film, frames, [](const Image&, const Damage&) {}); });
    const media::CheckedVideo checked =
        media::check_video_output({.path = path, .def = video, .end = frames, .force = true});
    media::VideoFile file(checked, {});
    media::FrameMaker maker(checked.format, 0, {});
    std::int64_t k = 0;
    draw_frames(*film, frames, [&](const Image& picture, const Damage& damage) {
        media::ReadyFrame ready;
        clock.measure("convert", [&] { ready = maker.make(k++, picture, damage); });
        clock.measure("encode", [&] { file.add(std::move(ready)); });
    });
    clock.measure("end and check", [&] { file.commit(); });
    return clock.to_json();
}

}  // namespace

json in_child(const std::function<json()>& work) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw Error(ExitCode::kTemporary, "the system makes no further pipe");
    const pid_t child = ::fork();
    if (child < 0) throw Error(ExitCode::kTemporary, "the system starts no further process; try again");
    if (child == 0) {
        const std::string text = work().dump();
        ::_exit(write_all(ends[1], text) == 0 ? 0 : 1);
    }
    ::close(ends[1]);
    std::string text;
    std::array<char, 4096> part{};
    for (ssize_t count = 0; (count = ::read(ends[0], part.data(), part.size())) > 0;)
        text.append(part.data(), static_cast<std::size_t>(count));
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (status != 0)
        throw Error(WIFEXITED(status) ? static_cast<ExitCode>(WEXITSTATUS(status)) : ExitCode::kTemporary,
                    "the process that measures has failed");
    return json::parse(text);
}

Measured measure(const BenchDef& def) {
    const TemporaryFolder folder;
    const std::string path = folder.file("video.mp4");
    Measured measured;
    measured.frames = frames_of(def);
    measured.pictures = std::min(measured.frames, max_pictures(def.scene.video));
    for (int i = 0; i < def.repeats; ++i) {
        const json rendered = in_child([&] { return render(def, path); });
        const json encoded = in_child([&] { return encode_alone(def); });
        const auto render_s = rendered["wall_s"].get<double>();
        const auto encoder_s = encoded["wall_s"].get<double>();
        measured.render_s.add(render_s);
        measured.encoder_s.add(encoder_s);
        measured.ratio.add(render_s / encoder_s);
        measured.peak_rss_mib = std::max(measured.peak_rss_mib, rendered["peak_rss_mib"].get<double>());
        measured.encoder_rss_mib =
            std::max(measured.encoder_rss_mib, encoded["encoder_rss_mib"].get<double>());
    }
    for (const json& stage : in_child([&] { return measure_stages(def, path); }))
        measured.stages.push_back(
            {stage["name"].get<std::string>(), stage["wall_s"].get<double>(), stage["cpu_s"].get<double>()});
    return measured;
}

}  // namespace corda::benchmark
