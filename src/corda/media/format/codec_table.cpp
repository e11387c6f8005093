#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"

// All that Corda knows of a codec is its row of kCodecs, the endings that name it in kEndings and, for an
// encoder of libav, its function of options. The bytes of an encoder depend on the definition alone, so it
// must not choose its number of threads.

namespace corda::media {
namespace {

constexpr std::array kX26xPresets{"ultrafast", "superfast", "veryfast", "faster",   "fast",
                                  "medium",    "slow",      "slower",   "veryslow", "placebo"};
constexpr std::array kNvencPresets{"p1", "p2", "p3", "p4", "p5", "p6", "p7"};
constexpr std::array kSpeeds{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13"};
constexpr std::span<const char* const> kSpeedsTo8{kSpeeds.data(), 9};

/// FFV1 splits a picture into 2x2 slices.
constexpr int kMinFfv1SidePx = 2;
/// Limit of SVT-AV1; AV1 allows more.
constexpr int kMaxSvtAv1HeightPx = 8704;
/// At 32 one clear pixel in 5000 has an alpha over 8, which shows as specks on white; at 20, one in 50 000.
constexpr int kVp9AlphaCrf = 20;
/// The 255 colours of a GIF are shared by all of its frames: a ground from red to blue is up to 11 off.
constexpr double kGifTolerance = 32.0;

EncoderOptions x265_options(const Format& format, const VideoDef& def) {
    // One frame at a time: the bytes depend on frame-threads, and pools start threads of all cores. B-frames
    // do not pay: without them a video of `first` takes a third less time for as many bytes and 0.6 dB more.
    const std::string pools = def.encoder.threads == 1 ? "none" : std::to_string(def.encoder.threads);
    return {{"preset", format.preset_of(def.encoder)},
            {"crf", std::to_string(format.crf_of(def.encoder))},
            {"x265-params",
             fmt::format("pools={}:frame-threads=1:open-gop=0:info=0:log-level=none:chromaloc=0:bframes=0",
                         pools)}};
}

EncoderOptions nvenc_options(const Format& format, const VideoDef& def) {
    return {{"preset", format.preset_of(def.encoder)},
            {"rc", "vbr"},
            {"cq", std::to_string(format.crf_of(def.encoder))},
            {"b", "0"},
            {"bf", "0"},
            {"forced-idr", "1"}};
}

EncoderOptions svt_av1_options(const Format& format, const VideoDef& def) {
    return {{"preset", format.preset_of(def.encoder)},
            {"crf", std::to_string(format.crf_of(def.encoder))},
            {"svtav1-params", fmt::format("lp={}", def.encoder.threads)}};
}

EncoderOptions aom_av1_options(const Format& format, const VideoDef& def) {
    return {{"cpu-used", format.preset_of(def.encoder)},
            {"crf", std::to_string(format.crf_of(def.encoder))},
            {"row-mt", "0"}};
}

EncoderOptions vp9_options(const Format& format, const VideoDef& def) {
    // libvpx keeps alpha in a second stream, which has no frames that are not shown.
    return {{"cpu-used", format.preset_of(def.encoder)},
            {"crf", std::to_string(format.crf_of(def.encoder))},
            {"b", "0"},
            {"deadline", "good"},
            {"row-mt", "0"},
            {"auto-alt-ref", format.has_alpha ? "0" : "1"}};
}

EncoderOptions prores_options(const Format& format, const VideoDef& /*def*/) {
    // The finest quantizer, which prores_ks finds for drawings by itself, trying all in six times the time.
    constexpr int kQuantizer = 1;
    return {{"profile", "4444"},
            {"alpha_bits", format.has_alpha ? "16" : "0"},
            {"vendor", "apl0"},
            {"flags", "+qscale"},
            {"global_quality", std::to_string(kQuantizer * FF_QP2LAMBDA)}};
}

EncoderOptions ffv1_options(const Format& /*format*/, const VideoDef& def) {
    // libavcodec limits the pixels of a slice: of R'G'B' with alpha to 3.7 million.
    constexpr std::int64_t kSlicePixels = 3'500'000;
    constexpr std::array<int, 5> kSlices{4, 9, 16, 24, 30};
    const std::int64_t pixels = std::int64_t{def.width_px} * def.height_px;
    const auto* const slices = std::find_if(kSlices.begin(), kSlices.end() - 1,
                                            [&](int count) { return pixels <= count * kSlicePixels; });
    // Version 3, each frame on its own, checksums of every slice.
    return {
        {"level", "3"}, {"g", "1"}, {"slices", std::to_string(*slices)}, {"slicecrc", "1"}, {"context", "0"}};
}

constexpr std::array kCodecs{
    Codec{.name = "libx264",
          .short_name = "h264",
          .standard = "H.264",
          .stream = "h264",
          .pixel_formats = {"yuv420p", "yuv444p"},
          .presets = kX26xPresets,
          .default_preset = "veryfast",
          .crf = {{1, 51}},
          .default_crf = 16,
          .has_coarse_444 = true,
          .make = &make_x264_encoder,
          .version = &x264_version},
    Codec{.name = "libx265",
          .short_name = "h265",
          .standard = "H.265",
          .stream = "hevc",
          .pixel_formats = {"yuv420p", "yuv444p"},
          .presets = kX26xPresets,
          .default_preset = "medium",
          .crf = {{1, 51}},
          .default_crf = 23,
          // x265 3.5 damages its heap in a picture of less than a block of 64 px, and reads memory that
          // nothing wrote in one that is a single block wide.
          .min_side_px = 66,
          .own_threads = 2,
          .has_coarse_444 = true,
          .options = &x265_options},
    Codec{.name = "libsvtav1",
          .short_name = "av1",
          .standard = "AV1",
          .stream = "av1",
          .pixel_formats = {"yuv420p"},
          .presets = kSpeeds,
          .default_preset = "8",
          .crf = {{1, 63}},
          .default_crf = 32,
          .min_side_px = 64,
          .max_height_px = kMaxSvtAv1HeightPx,
          .must_drain = true,
          .own_threads = 16,
          .options = &svt_av1_options},
    Codec{.name = "libaom-av1",
          .short_name = "av1",
          .standard = "AV1",
          .stream = "av1",
          .pixel_formats = {"yuv420p", "yuv444p"},
          .presets = kSpeedsTo8,
          .default_preset = "6",
          .crf = {{1, 63}},
          .default_crf = 20,
          .min_side_px = 16,
          .options = &aom_av1_options},
    Codec{.name = "libvpx-vp9",
          .short_name = "vp9",
          .standard = "VP9",
          .stream = "vp9",
          .pixel_formats = {"yuv420p", "yuva420p", "yuv444p"},
          .presets = kSpeedsTo8,
          .default_preset = "4",
          .crf = {{1, 63}},
          .default_crf = 32,
          .default_crf_of_alpha = kVp9AlphaCrf,
          .options = &vp9_options},
    Codec{.name = "h264_nvenc",
          .short_name = "nvenc",
          .standard = "H.264",
          .stream = "h264",
          .pixel_formats = {"yuv420p", "yuv444p"},
          .presets = kNvencPresets,
          .default_preset = "p5",
          .crf = {{1, 51}},
          .default_crf = 18,
          .min_side_px = 160,
          .is_hardware = true,
          .options = &nvenc_options},
    Codec{.name = "prores_ks",
          .short_name = "prores",
          .standard = "ProRes 4444",
          .stream = "prores",
          .pixel_formats = {"yuv444p10le", "yuva444p10le"},
          .options = &prores_options},
    Codec{.name = "ffv1",
          .short_name = "ffv1",
          .standard = "FFV1",
          .stream = "ffv1",
          .pixel_formats = {"bgr0", "bgra"},
          .min_side_px = kMinFfv1SidePx,
          .options = &ffv1_options},
    Codec{.name = "png",
          .short_name = "png",
          .standard = "PNG",
          .stream = "png",
          .pixel_formats = {"rgba"},
          .is_built_in = true},
    Codec{.name = "rawvideo",
          .short_name = "raw",
          .standard = "raw pictures",
          .stream = "rawvideo",
          .pixel_formats = {"yuv420p", "yuv444p", "rgba"},
          .is_built_in = true},
    Codec{.name = "gif",
          .short_name = "gif",
          .standard = "GIF",
          .stream = "gif",
          .pixel_formats = {"rgba"},
          .tolerance = kGifTolerance},
};

constexpr std::array kEndings{
    Ending{".mp4",
           "MP4",
           FileKind::kVideo,
           "mp4",
           {"libx264", "libsvtav1", "libx265", "libaom-av1", "h264_nvenc"}},
    Ending{".webm", "WebM", FileKind::kVideo, "webm", {"libvpx-vp9", "libsvtav1", "libaom-av1"}},
    Ending{".mov", "QuickTime", FileKind::kVideo, "mov", {"prores_ks"}},
    Ending{".mkv", "Matroska", FileKind::kVideo, "matroska", {"ffv1"}},
    Ending{".gif", "GIF", FileKind::kAnimation, "gif", {"gif"}},
    Ending{"%04d.png", "PNG pictures", FileKind::kPictures, "", {"png"}},
    Ending{"-", "YUV4MPEG2", FileKind::kStream, "", {"rawvideo"}},
};

}  // namespace

std::span<const Codec> codecs() {
    return kCodecs;
}

std::span<const Ending> endings() {
    return kEndings;
}

}  // namespace corda::media
