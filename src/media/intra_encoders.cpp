#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "corda/media/encoders.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

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
