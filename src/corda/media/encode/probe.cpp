#include "corda/media/encode/probe.hpp"

#include <fmt/format.h>

#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/pixels.hpp"

namespace corda::media {
namespace {

/// Encodes a picture of the least size that every encoder takes.
void encode_one(const Ending& ending, const Codec& codec) {
    VideoDef def;
    def.width_px = 320;
    def.height_px = 192;
    def.fps = FrameRate(Rational{50, 1});
    def.encoder.codec = ending.kind == FileKind::kAnimation ? "" : codec.name;
    const std::string name = ending.kind == FileKind::kStream ? "-" : std::string("a") + ending.text;
    Format format = find_format(name, def);
    if (ending.kind == FileKind::kAnimation) format.pixel_format = "pal8";
    if (format.codec->is_built_in) return;
    check_threads(*format.codec);
    const auto ignore = [](AVPacket&) {};
    const std::unique_ptr<Encoder> encoder = make_encoder(format, def);
    Frame frame = new_frame(av_get_pix_fmt(format.pixel_format), def.width_px, def.height_px);
    for (AVBufferRef* const buffer : frame->buf)
        if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
    encoder->encode(std::move(frame), {}, ignore);
    encoder->drain(ignore);
    if (*ending.muxer != '\0' && av_guess_format(ending.muxer, nullptr, nullptr) == nullptr)
        throw_error(ExitCode::kEncoder, "this libavformat does not write {}", ending.words);
}

EncoderProbe probe(const Ending& ending, const Codec& codec) {
    EncoderProbe probe{ending.text, codec.name, "", false};
    try {
        encode_one(ending, codec);
    } catch (const std::bad_alloc&) {
        probe.reason = "out of memory";
        probe.is_temporary = true;
    } catch (const Error& error) {
        if (error.code() == ExitCode::kInterrupted) throw;
        probe.reason = error.what();
        probe.is_temporary = error.code() == ExitCode::kTemporary;
    }
    return probe;
}

}  // namespace

std::vector<EncoderProbe> probe_encoders() {
    std::vector<EncoderProbe> probes;
    for (const Ending& ending : endings()) {
        for (const char* const name : ending.codecs)
            if (name != nullptr) probes.push_back(probe(ending, *find_codec(name)));
    }
    return probes;
}

void check_threads(const Codec& codec) {
    if (can_start_threads(codec.own_threads)) return;
    throw_error(ExitCode::kTemporary,
                "{} starts {} threads, and the system gives fewer: run fewer processes, or raise the limit "
                "(ulimit -u)",
                codec.name, codec.own_threads);
}

}  // namespace corda::media
