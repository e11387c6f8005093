#include "corda/media/encode/encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "corda/media/libav_handles.hpp"

namespace corda::media {

EncoderSettings x265_settings(const Format& format, const VideoDef& def) {
    // One frame at a time: the bytes depend on frame-threads, and pools start threads of all cores. B-frames
    // do not pay: without them a video of `first` takes a third less time for as many bytes and 0.6 dB more.
    const std::string pools = def.encoder.threads == 1 ? "none" : std::to_string(def.encoder.threads);
    return {-99,
            {{"preset", format.preset_of(def.encoder)},
             {"crf", std::to_string(format.crf_of(def.encoder))},
             {"x265-params",
              fmt::format("pools={}:frame-threads=1:open-gop=0:info=0:log-level=none:chromaloc=0:bframes=0",
                          pools)}},
            0};
}

EncoderSettings nvenc_settings(const Format& format, const VideoDef& def) {
    const bool is_420 = std::string_view(format.pixel_format) == "yuv420p";
    return {is_420 ? FF_PROFILE_H264_HIGH : FF_PROFILE_H264_HIGH_444_PREDICTIVE,
            {{"preset", format.preset_of(def.encoder)},
             {"rc", "vbr"},
             {"cq", std::to_string(format.crf_of(def.encoder))},
             {"b", "0"},
             {"bf", "0"},
             {"forced-idr", "1"}},
            0};
}

EncoderSettings svt_av1_settings(const Format& format, const VideoDef& def) {
    return {-99,
            {{"preset", format.preset_of(def.encoder)},
             {"crf", std::to_string(format.crf_of(def.encoder))},
             {"svtav1-params", fmt::format("lp={}", def.encoder.threads)}},
            0};
}

EncoderSettings aom_av1_settings(const Format& format, const VideoDef& def) {
    return {-99,
            {{"cpu-used", format.preset_of(def.encoder)},
             {"crf", std::to_string(format.crf_of(def.encoder))},
             {"row-mt", "0"}},
            0};
}

EncoderSettings vp9_settings(const Format& format, const VideoDef& def) {
    // libvpx keeps alpha in a second stream, which has no frames that are not shown.
    return {-99,
            {{"cpu-used", format.preset_of(def.encoder)},
             {"crf", std::to_string(format.crf_of(def.encoder))},
             {"b", "0"},
             {"deadline", "good"},
             {"row-mt", "0"},
             {"auto-alt-ref", format.has_alpha ? "0" : "1"}},
            0};
}

EncoderSettings prores_settings(const Format& format, const VideoDef& /*def*/) {
    // The finest quantizer, which prores_ks finds for drawings by itself, trying all in six times the time.
    constexpr int kQuantizer = 1;
    return {-99,
            {{"profile", "4444"},
             {"alpha_bits", format.has_alpha ? "16" : "0"},
             {"vendor", "apl0"},
             {"flags", "+qscale"},
             {"global_quality", std::to_string(kQuantizer * FF_QP2LAMBDA)}},
            0};
}

EncoderSettings ffv1_settings(const Format& /*format*/, const VideoDef& def) {
    // libavcodec limits the pixels of a slice: of R'G'B' with alpha to 3.7 million.
    constexpr std::int64_t kSlicePixels = 3'500'000;
    constexpr std::array<int, 5> kSlices{4, 9, 16, 24, 30};
    const std::int64_t pixels = std::int64_t{def.width_px} * def.height_px;
    const auto* const slices = std::find_if(kSlices.begin(), kSlices.end() - 1,
                                            [&](int count) { return pixels <= count * kSlicePixels; });
    // Version 3, each frame on its own, checksums of every slice.
    return {-99,
            {{"level", "3"},
             {"g", "1"},
             {"slices", std::to_string(*slices)},
             {"slicecrc", "1"},
             {"context", "0"}},
            0};
}

EncoderSettings exact_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    return {-99, {}, 0};
}

}  // namespace corda::media
