#include "benchmark/video/encodings.hpp"

extern "C" {
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "benchmark/video/measure.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/read/decoder.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "support/edge_quality.hpp"

namespace corda::benchmark {
namespace {

using nlohmann::json;

/// Every tenth frame is compared.
constexpr std::int64_t kCompared = 10;

/// Converts decoded frames of any pixel format to 8-bit RGBA as a player does, which interpolates chroma.
class ShownPictures {
  public:
    /// Converts by the frame's own tags, BT.709 in limited range if it has none.
    void convert(const AVFrame& frame, Image& picture);

  private:
    struct Free {
        void operator()(SwsContext* context) const { sws_freeContext(context); }
    };
    std::unique_ptr<SwsContext, Free> scaler_;  ///< of the last frame's size and format
};

void ShownPictures::convert(const AVFrame& frame, Image& picture) {
    const auto format = static_cast<AVPixelFormat>(frame.format);
    // Chroma is interpolated, not repeated, and nothing is rounded to the speed of a CPU's instructions.
    constexpr int kFlags =
        SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_ACCURATE_RND | SWS_BITEXACT;
    scaler_.reset(sws_getCachedContext(scaler_.release(), frame.width, frame.height, format, frame.width,
                                       frame.height, AV_PIX_FMT_RGBA, kFlags, nullptr, nullptr, nullptr));
    if (!scaler_) throw Error(ExitCode::kIo, "pictures of this pixel format cannot be converted");
    const int matrix =
        frame.colorspace == AVCOL_SPC_UNSPECIFIED ? SWS_CS_ITU709 : static_cast<int>(frame.colorspace);
    const int* const table = sws_getCoefficients(matrix);
    const int is_full_range = frame.color_range == AVCOL_RANGE_JPEG ? 1 : 0;
    constexpr int kOne = 1 << 16;
    sws_setColorspaceDetails(scaler_.get(), table, is_full_range, table, 1, 0, kOne, kOne);
    if (picture.width() != frame.width || picture.height() != frame.height)
        picture = Image(frame.width, frame.height);
    std::uint8_t* const rows = picture.data();
    const auto row_bytes = static_cast<int>(picture.row_bytes());
    sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, &rows, &row_bytes);
}

/// The quality of the video at `path`.
json quality_of(Film& film, std::int64_t frames, const std::string& path) {
    FilmRenderer renderer(film);
    media::Decoder decoder(path);
    ShownPictures pictures;
    test::EdgeQuality edges;
    Image shown;
    for (std::int64_t k = 0; k < frames; ++k) {
        if (!decoder.read()) throw Error(ExitCode::kEncoder, "the video has too few frames");
        if (k % kCompared != 0) continue;
        pictures.convert(decoder.frame(), shown);
        static_cast<void>(renderer.draw(film.time_s(k)));
        edges.add(renderer.image(), shown);
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
