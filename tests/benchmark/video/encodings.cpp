#include "benchmark/video/encodings.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "benchmark/video/measure.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/film/film.hpp"
#include "corda/media/format/format.hpp"
#include "support/edge_quality.hpp"

namespace corda::benchmark {
namespace {

using nlohmann::json;

/// Every tenth frame is compared.
constexpr std::int64_t kCompared = 10;

/// The frames of a video as 8-bit RGBA, by the program ffmpeg, which interpolates chroma as a player does.
class ShownPictures {
  public:
    ShownPictures(const std::string& path, int width_px, int height_px)
        : image_(width_px, height_px),
          pipe_(::popen(("ffmpeg -v error -i '" + path +
                         "' -vf scale=flags=bilinear+full_chroma_int+full_chroma_inp+accurate_rnd+bitexact,"
                         "format=rgba -f rawvideo -")
                            .c_str(),
                        "r")) {}

    /// Reads the next frame; false after the last one.
    [[nodiscard]] bool read() {
        return std::fread(image_.data(), 1, image_.size_bytes(), pipe_.get()) == image_.size_bytes();
    }
    [[nodiscard]] const Image& image() const { return image_; }

  private:
    struct Close {
        void operator()(std::FILE* pipe) const { ::pclose(pipe); }
    };
    Image image_;
    std::unique_ptr<std::FILE, Close> pipe_;
};

/// The quality of the video at `path`.
json quality_of(const Film& film, std::int64_t frames, const std::string& path) {
    ShownPictures pictures(path, film.scene().video.width_px, film.scene().video.height_px);
    test::EdgeQuality edges;
    for (std::int64_t k = 0; k < frames; ++k) {
        if (!pictures.read()) throw Error(ExitCode::kEncoder, "the video has too few frames");
        if (k % kCompared != 0) continue;
        edges.add(film.frame(k), pictures.image());
    }
    return {{"edge_psnr_db", test::psnr_db(edges.mean_square())}, {"edge_ssim", edges.ssim()}};
}

json render_and_compare(const EncodingDef& def, std::int64_t frames) {
    const TemporaryFolder folder;
    const std::string path = folder.file("video" + def.ending);
    const double start_s = now_s();
    Film film(def.scene, def.film);
    RenderDef render;
    render.end = frames;
    static_cast<void>(render_video(film, path, render));
    const double wall_s = now_s() - start_s;
    json result{{"wall_s", wall_s}, {"bytes", file_size(path)}};
    result.update(quality_of(film, frames, path));
    return result;
}

}  // namespace

std::vector<Encoding> usual_encodings() {
    std::vector<Encoding> all;
    const auto add = [&all](const std::string& ending, std::vector<Setting> settings) {
        all.push_back({ending, std::move(settings)});
    };
    for (const char* const preset :
         {"ultrafast", "superfast", "veryfast", "faster", "fast", "medium", "slow", "slower"})
        add(".mp4", {"video.codec=h264", std::string("video.preset=") + preset});
    for (const char* const crf : {"12", "14", "18", "20", "24"})
        add(".mp4", {"video.codec=h264", std::string("video.crf=") + crf});
    add(".mp4", {"video.codec=h264", "video.preset=medium", "video.crf=18"});
    add(".mp4", {"video.codec=h264", "video.pix=\"444\""});
    add(".mp4", {"video.codec=h265"});
    add(".mp4", {"video.codec=av1"});
    add(".webm", {"video.codec=vp9"});
    return all;
}

MeasuredEncoding measure_encoding(const EncodingDef& def) {
    const VideoDef& video = def.scene.video;
    const media::Format format = media::find_format("video" + def.ending, video);
    MeasuredEncoding measured;
    measured.codec = format.codec->short_name;
    measured.preset = format.preset_of(video.encoder);
    if (format.codec->crf) measured.crf = format.crf_of(video.encoder);
    measured.pixels = format.pixel_format;
    measured.frames = std::min(def.frames, video.fps.frame_count(def.scene.world.duration_s));
    const json result = in_child([&] { return render_and_compare(def, measured.frames); });
    measured.wall_s = result["wall_s"].get<double>();
    measured.bytes = result["bytes"].get<std::uintmax_t>();
    measured.edge_psnr_db = result["edge_psnr_db"].get<double>();
    measured.edge_ssim = result["edge_ssim"].get<double>();
    return measured;
}

}  // namespace corda::benchmark
