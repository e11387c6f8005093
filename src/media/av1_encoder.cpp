#include <fmt/format.h>

#include "corda/media/encoders.hpp"

namespace corda::media {

EncoderSettings svt_av1_settings(const Format& format, const EncoderDef& def) {
    return {-99,
            {{"preset", format.preset_of(def)},
             {"crf", std::to_string(format.crf_of(def))},
             {"svtav1-params", fmt::format("lp={}", def.threads)}},
            0};
}

EncoderSettings aom_av1_settings(const Format& format, const EncoderDef& def) {
    return {
        -99,
        {{"cpu-used", format.preset_of(def)}, {"crf", std::to_string(format.crf_of(def))}, {"row-mt", "0"}},
        0};
}

}  // namespace corda::media
