#include "corda/media/probe.hpp"

#include <algorithm>

#include "corda/core/basics.hpp"
#include "corda/media/encoder.hpp"
#include "corda/media/format.hpp"

namespace corda::media {
namespace {

EncoderProbe probe(const Format& format) {
    VideoDef def;
    // Large enough for the minimum of every encoder, small enough to open at once.
    def.width_px = 320;
    def.height_px = 192;
    def.encoder.threads = 1;
    const Image image(def.width_px, def.height_px);
    const auto ignore = [](AVPacket&) {};
    try {
        const auto encoder = format.make_encoder(format, def);
        encoder->encode(image, {image.rect()}, ignore);
        encoder->drain(ignore);
    } catch (const Error& error) {
        return {format.codec, false, error.what()};
    }
    return {format.codec, true, ""};
}

}  // namespace

std::vector<EncoderProbe> probe_encoders() {
    std::vector<EncoderProbe> probes;
    for (const Format& format : formats()) {
        const bool is_known = std::any_of(probes.begin(), probes.end(),
                                          [&](const EncoderProbe& p) { return p.name == format.codec; });
        if (!is_known) probes.push_back(probe(format));
    }
    return probes;
}

}  // namespace corda::media
