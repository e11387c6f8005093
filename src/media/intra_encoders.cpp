#include "corda/media/encoders.hpp"

namespace corda::media {

EncoderSettings prores_settings(const Format& format, const VideoDef& /*def*/) {
    return {-99, {{"profile", "4444"}, {"alpha_bits", format.has_alpha ? "16" : "0"}, {"vendor", "apl0"}}, 0};
}

EncoderSettings ffv1_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    // Version 3, each frame on its own, checksums of every slice.
    return {-99, {{"level", "3"}, {"g", "1"}, {"slices", "4"}, {"slicecrc", "1"}, {"context", "0"}}, 0};
}

EncoderSettings exact_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    return {-99, {}, 0};
}

}  // namespace corda::media
