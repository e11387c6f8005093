#include "corda/media/probe.hpp"

#include <string_view>

#include "corda/core/basics.hpp"
#include "corda/media/encoders.hpp"
#include "corda/media/format.hpp"

namespace corda::media {
namespace {

std::string reason_of(const Ending& ending, const Codec& codec) {
    VideoDef def;
    // Large enough for the minimum of every encoder, small enough to open at once.
    def.width_px = 320;
    def.height_px = 192;
    def.fps = FrameRate(Rational{50, 1});
    def.encoder.codec = ending.kind == FileKind::kAnimation ? "" : codec.name;
    const Image image(def.width_px, def.height_px);
    const auto ignore = [](AVPacket&) {};
    try {
        const std::string name = ending.kind == FileKind::kStream ? "-" : std::string("a") + ending.text;
        const auto encoder = make_encoder(find_format(name, def), def);
        encoder->encode(image, {image.rect()}, ignore);
        encoder->drain(ignore);
    } catch (const Error& error) {
        return error.what();
    }
    if (*ending.muxer != '\0' && std::string_view(ending.muxer) != "webp" &&
        av_guess_format(ending.muxer, nullptr, nullptr) == nullptr)
        return "this libavformat does not write " + std::string(ending.words);
    const bool has_codec = ending.kind != FileKind::kAnimation || std::string_view(ending.muxer) == "webp" ||
                           avcodec_find_encoder_by_name(ending.muxer) != nullptr;
    return has_codec ? "" : "this libavcodec was built without " + std::string(ending.muxer);
}

}  // namespace

std::vector<EncoderProbe> probe_encoders() {
    std::vector<EncoderProbe> probes;
    for (const Ending& ending : endings()) {
        for (const char* const name : ending.codecs) {
            if (name == nullptr) continue;
            const std::string reason = reason_of(ending, *find_codec(name));
            const bool is_animation = ending.kind == FileKind::kAnimation;
            probes.push_back({ending.text, is_animation ? ending.muxer : name, reason.empty(), reason});
        }
    }
    return probes;
}

}  // namespace corda::media
