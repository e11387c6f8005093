#include <fmt/format.h>

#include "corda/media/encoders.hpp"

namespace corda::media {

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

}  // namespace corda::media
