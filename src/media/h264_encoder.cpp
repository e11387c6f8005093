#include "corda/media/encoders.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

/// Of 4:2:0 High (x264's preset ultrafast gives Constrained Baseline), which browsers and QuickTime play.
int h264_profile(const Format& format) {
    return std::string_view(format.pixel_format) == "yuv420p" ? FF_PROFILE_H264_HIGH
                                                              : FF_PROFILE_H264_HIGH_444_PREDICTIVE;
}

}  // namespace

EncoderSettings x264_settings(const Format& format, const EncoderDef& def) {
    return {h264_profile(format),
            {{"preset", format.preset_of(def)}, {"crf", std::to_string(format.crf_of(def))}},
            std::nullopt};
}

EncoderSettings nvenc_settings(const Format& format, const EncoderDef& def) {
    return {h264_profile(format),
            {{"preset", format.preset_of(def)},
             {"rc", "vbr"},
             {"cq", std::to_string(format.crf_of(def))},
             {"b", "0"},
             {"bf", "0"},
             {"forced-idr", "1"}},
            0};
}

}  // namespace corda::media
