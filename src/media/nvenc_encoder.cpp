#include <string>
#include <string_view>

#include "corda/media/encoders.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

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

}  // namespace corda::media
