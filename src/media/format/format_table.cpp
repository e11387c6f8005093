#include <array>
#include <span>

#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {
namespace {

constexpr std::array kX26xPresets{"ultrafast", "superfast", "veryfast", "faster",   "fast",
                                  "medium",    "slow",      "slower",   "veryslow", "placebo"};
constexpr std::array kNvencPresets{"p1", "p2", "p3", "p4", "p5", "p6", "p7"};
constexpr std::array kSpeeds{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13"};
constexpr std::span<const char* const> kSpeedsTo8{kSpeeds.data(), 9};

/// Of codecs whose frames stand alone: less is in memory, and more is safe.
constexpr int kFewFrames = 12;
/// Of FFV1, whose encoder clears 148 bytes per pixel when it opens.
constexpr int kFfv1Frames = 36;
/// FFV1 splits a picture into 2x2 slices.
constexpr int kMinFfv1SidePx = 2;
/// Limits of SVT-AV1; AV1 allows more.
constexpr int kMaxSvtAv1HeightPx = 8704;
/// At 32 one clear pixel in 5000 has an alpha over 8, which shows as specks on white; at 20, one in 50 000.
constexpr int kVp9AlphaCrf = 20;
/// WebP stores each side in 14 bits.
constexpr int kMaxWebpSidePx = (1 << 14) - 1;

constexpr std::array kCodecs{
    Codec{"libx264",
          "h264",
          "H.264",
          {"yuv420p", "yuv444p"},
          kX26xPresets,
          "veryfast",
          {{1, 51}},
          16,
          1,
          0,
          false,
          EncoderOrigin::kX264},
    Codec{"libx265",
          "h265",
          "H.265",
          {"yuv420p", "yuv444p"},
          kX26xPresets,
          "medium",
          {{1, 51}},
          23,
          32,
          0,
          false,
          EncoderOrigin::kLibav,
          &x265_settings},
    Codec{"libsvtav1",
          "av1",
          "AV1",
          {"yuv420p"},
          kSpeeds,
          "8",
          {{1, 63}},
          32,
          64,
          0,
          false,
          EncoderOrigin::kLibav,
          &svt_av1_settings,
          kMaxSvtAv1HeightPx},
    Codec{"libaom-av1",
          "av1",
          "AV1",
          {"yuv420p", "yuv444p"},
          kSpeedsTo8,
          "6",
          {{1, 63}},
          20,
          16,
          0,
          false,
          EncoderOrigin::kLibav,
          &aom_av1_settings},
    Codec{"libvpx-vp9",
          "vp9",
          "VP9",
          {"yuv420p", "yuva420p", "yuv444p"},
          kSpeedsTo8,
          "4",
          {{1, 63}},
          32,
          1,
          0,
          false,
          EncoderOrigin::kLibav,
          &vp9_settings,
          kMaxSidePx,
          kVp9AlphaCrf},
    Codec{"h264_nvenc",
          "nvenc",
          "H.264",
          {"yuv420p", "yuv444p"},
          kNvencPresets,
          "p5",
          {{1, 51}},
          18,
          160,
          0,
          true,
          EncoderOrigin::kLibav,
          &nvenc_settings},
    Codec{"prores_ks",
          "prores",
          "ProRes 4444",
          {"yuv444p10le", "yuva444p10le"},
          {},
          "",
          {},
          0,
          1,
          kFewFrames,
          false,
          EncoderOrigin::kLibav,
          &prores_settings},
    Codec{"ffv1",
          "ffv1",
          "FFV1",
          {"bgr0", "bgra"},
          {},
          "",
          {},
          0,
          kMinFfv1SidePx,
          kFfv1Frames,
          false,
          EncoderOrigin::kLibav,
          &ffv1_settings},
    Codec{"qtrle",
          "rle",
          "QuickTime Animation",
          {"rgb24", "argb"},
          {},
          "",
          {},
          0,
          1,
          0,
          false,
          EncoderOrigin::kLibav,
          &exact_settings},
    Codec{"png", "png", "PNG", {"rgba"}, {}, "", {}, 0, 1, kFewFrames, false, EncoderOrigin::kPng},
    Codec{"rawvideo",
          "raw",
          "raw pictures",
          {"yuv420p", "yuv444p", "rgba"},
          {},
          "",
          {},
          0,
          1,
          2,
          false,
          EncoderOrigin::kLibav,
          &exact_settings},
};

constexpr std::array kEndings{
    Ending{".mp4",
           "MP4",
           FileKind::kVideo,
           "mp4",
           "mp4",
           {"libx264", "libsvtav1", "libx265", "libaom-av1", "h264_nvenc"},
           "H.264: everything; AV1: browsers; H.265: Safari, QuickTime, TVs"},
    Ending{".webm",
           "WebM",
           FileKind::kVideo,
           "webm",
           "matroska",
           {"libvpx-vp9", "libsvtav1", "libaom-av1"},
           "browsers, VLC, mpv"},
    Ending{".mov",
           "QuickTime",
           FileKind::kVideo,
           "mov",
           "mov",
           {"prores_ks"},
           "video editors, QuickTime, Keynote"},
    Ending{".mkv", "Matroska", FileKind::kVideo, "matroska", "matroska", {"ffv1"}, "VLC, mpv, ffmpeg"},
    Ending{".gif", "GIF", FileKind::kAnimation, "gif", "mov", {"qtrle"}, "everything; PowerPoint"},
    Ending{".apng", "APNG", FileKind::kAnimation, "apng", "mov", {"qtrle"}, "browsers"},
    Ending{".webp", "WebP", FileKind::kAnimation, "webp", "mov", {"qtrle"}, "browsers", kMaxWebpSidePx},
    Ending{"%04d.png", "PNG pictures", FileKind::kPictures, "", "", {"png"}, "everything, as pictures"},
    Ending{"-", "YUV4MPEG2", FileKind::kStream, "", "", {"rawvideo"}, "ffmpeg and other encoders"},
};

}  // namespace

std::span<const Ending> endings() {
    return kEndings;
}

std::span<const Codec> codecs() {
    return kCodecs;
}

}  // namespace corda::media
