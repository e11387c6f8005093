#include "corda/media/encoders.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

/// Of 4:2:0 High (x264's preset ultrafast gives Constrained Baseline), which browsers and QuickTime play.
int h264_profile(const Format& format) {
    return std::string_view(format.pixel_format) == "yuv420p" ? FF_PROFILE_H264_HIGH
                                                              : FF_PROFILE_H264_HIGH_444_PREDICTIVE;
}

/// Whether x264 (164) weighs macroblocks by memory that nobody wrote: with AVX-512 its macroblock tree takes
/// eight at a time, also at the end of a row. One in a hundred videos of 480 columns had other bytes. Without
/// AVX-512 it gives the same bytes as with it when all goes well, and takes a sixth more time.
bool reads_beyond_its_rows(int width_px) {
#if defined(__x86_64__)
    constexpr int kMacroblockPx = 16;
    constexpr int kAtATime = 8;
    return (width_px + kMacroblockPx - 1) / kMacroblockPx % kAtATime != 0 &&
           __builtin_cpu_supports("avx512f") != 0;
#else
    return width_px < 0;
#endif
}

}  // namespace

EncoderSettings x264_settings(const Format& format, const VideoDef& def) {
    EncoderSettings settings{
        h264_profile(format),
        {{"preset", format.preset_of(def.encoder)}, {"crf", std::to_string(format.crf_of(def.encoder))}},
        std::nullopt};
    if (reads_beyond_its_rows(def.width_px)) settings.options.emplace_back("x264-params", "asm=AVX2");
    return settings;
}

EncoderSettings nvenc_settings(const Format& format, const VideoDef& def) {
    return {h264_profile(format),
            {{"preset", format.preset_of(def.encoder)},
             {"rc", "vbr"},
             {"cq", std::to_string(format.crf_of(def.encoder))},
             {"b", "0"},
             {"bf", "0"},
             {"forced-idr", "1"}},
            0};
}

}  // namespace corda::media
