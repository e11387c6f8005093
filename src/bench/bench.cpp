#include "corda/bench/bench.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/basics.hpp"
#include "corda/core/clock.hpp"
#include "corda/core/file.hpp"
#include "corda/media/child_process.hpp"
#include "corda/media/chunk.hpp"
#include "corda/media/encoder_alone.hpp"
#include "corda/media/format.hpp"
#include "corda/media/verify.hpp"
#include "corda/media/yuv420.hpp"
#include "corda/pipeline/painter.hpp"

namespace corda::bench {
namespace {

using nlohmann::json;

constexpr double kMib = 1024.0 * 1024.0;
/// Of the pictures that an encoder is fed from memory.
constexpr double kMostPictureBytes = 1024.0 * kMib;

/// A folder for videos, removed with them.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "corda-bench-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) fail_file("make", name, errno);
        path_ = name;
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] std::string video() const { return path_ + "/video.mp4"; }

  private:
    std::string path_;
};

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

/// What `work` returns, from a child process.
json in_child(const BenchDef& def, const std::function<json()>& work) {
    const auto told = [&work] {
        try {
            return work().dump();
        } catch (const Error& error) {
            return json{{"code", static_cast<int>(error.code())}, {"error", error.what()}}.dump();
        }
    };
    constexpr double kLongestS = 86'400.0;
    const media::ChildLimits limits{std::uint64_t{1} << 46U, static_cast<std::int64_t>(kLongestS), kLongestS};
    const auto end = media::run_in_child(told, limits, def.on_wait);
    if (!end) throw Error(ExitCode::kTemporary, "the system starts no further process; try again");
    if (!end->finished) throw Error(ExitCode::kTemporary, "the process that measures " + end->text);
    json result = json::parse(end->text);
    if (result.contains("error"))
        throw Error(static_cast<ExitCode>(result["code"].get<int>()), result["error"].get<std::string>());
    return result;
}

/// How many frames are made of the scene.
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
    FilmPainter painter(film);
    for (std::int64_t k = 0; k < frames; ++k) {
        const Damage damage = painter.draw(film.time_s(k));
        use(painter.image(), damage);
    }
}

/// How many pictures are kept in memory.
std::int64_t most_pictures(const VideoDef& video) {
    constexpr double kBytesPerPixel = 1.5;
    const double bytes = kBytesPerPixel * video.width_px * video.height_px;
    return std::max<std::int64_t>(2, static_cast<std::int64_t>(kMostPictureBytes / bytes));
}

/// How many threads the machine runs at a time.
int cores() {
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

json encode_alone(const BenchDef& def) {
    const VideoDef& video = def.scene.video;
    media::EncoderAlone encoder(video);
    {
        const Film film(def.scene, def.film);
        draw_frames(film, std::min(frames_of(def), most_pictures(video)),
                    [&](const Image& picture, const Damage&) { encoder.add(picture); });
    }
    // What was freed must not serve the encoder, or its own memory would not show.
    malloc_trim(0);
    const double before_mib = memory_mib("VmRSS");
    reset_peak_memory();
    const std::int64_t chunk = std::min<std::int64_t>(frames_of(def), media::frames_per_chunk(video.fps));
    static_cast<void>(encoder.encode(chunk, 1));
    const double encoder_mib = memory_mib("VmHWM") - before_mib;
    const double start_s = now_s();
    static_cast<void>(encoder.encode(frames_of(def), cores()));
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

/// The stages, each by itself, on the video at `path`.
json measure_stages(const BenchDef& def, const std::string& path) {
    const VideoDef& video = def.scene.video;
    const std::int64_t frames = frames_of(def);
    StageClock clock;
    std::optional<Film> film;
    clock.measure("simulate", [&] {
        film.emplace(def.scene, def.film);
        static_cast<void>(film->camera());
    });
    clock.measure("open OpenGL", [&] { static_cast<void>(film->gl()); });
    clock.measure("draw", [&] { draw_frames(*film, frames, [](const Image&, const Damage&) {}); });
    media::Yuv420Image converted(video.width_px, video.height_px);
    media::EncoderAlone encoder(video);
    std::int64_t kept = most_pictures(video);
    draw_frames(*film, frames, [&](const Image& picture, const Damage& damage) {
        clock.measure("convert", [&] {
            for (const PixelRect& part : damage) media::convert_to_yuv420(picture, part, converted);
        });
        if (kept-- > 0) encoder.add(picture);
    });
    clock.measure("encode", [&] { static_cast<void>(encoder.encode(frames, 1)); });
    clock.measure("verify",
                  [&] { static_cast<void>(media::verify(path, {}, media::VerifyDepth::kKeyFrames)); });
    return clock.to_json();
}

}  // namespace

Measured measure(const BenchDef& def) {
    const ScratchFolder folder;
    Measured measured;
    measured.frames = frames_of(def);
    const int jobs = def.scene.video.encoder.jobs;
    measured.jobs = jobs == 0 ? cores() : jobs;
    for (int i = 0; i < def.repeats; ++i) {
        const json rendered = in_child(def, [&] { return render(def, folder.video()); });
        const json encoded = in_child(def, [&] { return encode_alone(def); });
        const auto render_s = rendered["wall_s"].get<double>();
        const auto encoder_s = encoded["wall_s"].get<double>();
        measured.render_s.add(render_s);
        measured.encoder_s.add(encoder_s);
        measured.ratio.add(render_s / encoder_s);
        measured.peak_rss_mib = std::max(measured.peak_rss_mib, rendered["peak_rss_mib"].get<double>());
        measured.encoder_rss_mib =
            std::max(measured.encoder_rss_mib, encoded["encoder_rss_mib"].get<double>());
    }
    for (const json& stage : in_child(def, [&] { return measure_stages(def, folder.video()); }))
        measured.stages.push_back(
            {stage["name"].get<std::string>(), stage["wall_s"].get<double>(), stage["cpu_s"].get<double>()});
    return measured;
}

}  // namespace corda::bench
