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

EncoderSettings ffv1_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    // Version 3, each frame on its own, checksums of every slice.
    return {-99, {{"level", "3"}, {"g", "1"}, {"slices", "4"}, {"slicecrc", "1"}, {"context", "0"}}, 0};
}

EncoderSettings exact_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    return {-99, {}, 0};
}

}  // namespace corda::media
