#include "corda/media/encoders.hpp"

namespace corda::media {

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

}  // namespace corda::media
