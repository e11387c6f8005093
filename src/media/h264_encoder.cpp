#include "corda/media/h264_encoder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "corda/core/basics.hpp"
#include "corda/media/yuv420_encoder.hpp"

namespace corda::media {
namespace {

/// The even numbers next to an odd side: "1080 or 1082".
std::string even_sides(int side) {
    return side % 2 == 0 ? std::to_string(side)
           : side == 1   ? std::string("2")
                         : fmt::format("{} or {}", side - 1, side + 1);
}

/// profile_idc of the sequence parameter set in Annex B extradata; -1 if there is none.
int profile_idc(const AVCodecContext& context) {
    const std::uint8_t* data = context.extradata;
    for (int i = 0; i + 4 < context.extradata_size; ++i) {
        const bool start_code = data[i] == 0 && data[i + 1] == 0 && data[i + 2] == 1;
        if (start_code && (data[i + 3] & 0x1f) == 7) return data[i + 4];
    }
    return -1;
}

/// Browsers and QuickTime play 8-bit 4:2:0 only, and x264 may choose otherwise without a word.
void check_playable(const AVCodecContext& context) {
    const int idc = profile_idc(context);
    const bool playable_profile =
        idc == FF_PROFILE_H264_BASELINE || idc == FF_PROFILE_H264_MAIN || idc == FF_PROFILE_H264_HIGH;
    if (context.pix_fmt == AV_PIX_FMT_YUV420P && playable_profile) return;
    const char* format = av_get_pix_fmt_name(context.pix_fmt);
    throw Error(
        ExitCode::kEncoder,
        fmt::format("libx264 chose pixel format {} and profile_idc {}, which browsers and QuickTime refuse; "
                    "use crf 1 to {} and no option that changes the profile",
                    format == nullptr ? "unknown" : format, idc, EncoderDef::kLargestCrf));
}

}  // namespace

const std::vector<std::string>& x264_presets() {
    static const std::vector<std::string> presets{"ultrafast", "superfast", "veryfast", "faster",
                                                  "fast",      "medium",    "slow",     "slower",
                                                  "veryslow",  "placebo"};
    return presets;
}

void check_h264(const VideoDef& def) {
    if (def.width_px % 2 != 0 || def.height_px % 2 != 0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("video size {}x{} is odd, and H.264 4:2:0 needs even sides; use a width of {} "
                        "and a height of {}",
                        def.width_px, def.height_px, even_sides(def.width_px), even_sides(def.height_px)));
    }
    const auto& presets = x264_presets();
    if (std::find(presets.begin(), presets.end(), def.encoder.preset) == presets.end()) {
        throw Error(ExitCode::kUsage, fmt::format("unknown preset '{}'; use one of {}", def.encoder.preset,
                                                  fmt::join(presets, ", ")));
    }
    if (def.encoder.crf < 1 || def.encoder.crf > EncoderDef::kLargestCrf) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("crf {} is out of range; use 1 to {} (0 is lossless 4:4:4, which browsers refuse)",
                        def.encoder.crf, EncoderDef::kLargestCrf));
    }
}

std::unique_ptr<Encoder> make_h264_encoder(const Format& format, const VideoDef& def) {
    const EncoderSettings settings{
        FF_PROFILE_H264_HIGH, {{"preset", def.encoder.preset}, {"crf", std::to_string(def.encoder.crf)}}};
    auto encoder = std::make_unique<Yuv420Encoder>(format, def, settings);
    check_playable(encoder->context());
    return encoder;
}

}  // namespace corda::media
