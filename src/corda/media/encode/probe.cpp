#include "corda/media/encode/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/child_process.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {
namespace {

constexpr double kMaxS = 5.0;  // measured 0.01 .. 0.2 s; all cores may be busy with other work
/// Address space of a drawing thread, measured as 400 to 430 MiB with Mesa 22.3.
constexpr std::uint64_t kDrawingBytes = std::uint64_t{430} << 20U;

/// Explains that the system starts fewer threads than an encoder waits for; empty if it starts enough.
std::string lack_of_threads(const Codec& codec) {
    if (can_start_threads(codec.own_threads)) return "";
    return fmt::format(
        "{} starts {} threads, and the system gives fewer: run fewer processes, or raise the limits (ulimit "
        "-u, ulimit -v)",
        codec.name, codec.own_threads);
}

/// Large enough for the minimum of every encoder, small enough to open at once.
VideoDef small_video(const VideoDef& like) {
    VideoDef def = like;
    def.width_px = 320;
    def.height_px = 192;
    return def;
}

/// Encodes a picture; returns what failed.
std::string encode_one(const Format& given, const VideoDef& def) {
    const auto ignore = [](AVPacket&) {};
    Format format = given;
    if (format.ending->kind == FileKind::kAnimation) format.pixel_format = "pal8";
    try {
        const auto encoder = make_encoder(format, def);
        Frame frame = new_frame(av_get_pix_fmt(format.pixel_format), def.width_px, def.height_px);
        for (AVBufferRef* const buffer : frame->buf)
            if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
        encoder->encode(std::move(frame), {}, ignore);
        encoder->drain(ignore);
    } catch (const std::bad_alloc&) {
        return std::string(format.codec->name) + " got no memory";
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

struct Trial {
    std::string failure;  ///< empty if it encodes
    bool is_temporary = false;
};

/// Tries an encoder in a child process with a time limit, which other threads rule out: see run_in_child.
/// With a limited address space the encoders have what drawing will leave of it, and their own size.
Trial try_encoder(const Format& format, const VideoDef& video, std::uint64_t kept_bytes) {
    const auto left = address_space_left();  // first, as threads leave some of it to the allocator
    if (std::string lack = lack_of_threads(*format.codec); !lack.empty()) return {std::move(lack), true};
    const VideoDef def = left ? video : small_video(video);
    ChildLimits limits{std::uint64_t{1} << 46U, std::int64_t{60}, kMaxS};
    if (left) limits.memory_bytes = *left - std::min(*left, kept_bytes);
    const auto work = [&] { return encode_one(format, def); };
    const auto end = run_in_child(work, limits);
    const auto starts_threads = [&] { return can_start_threads(1 + format.codec->own_threads); };
    if (!end && starts_threads()) return {};
    if (!end)
        return {
            "the system starts no further process or thread; run fewer processes, or raise the limit (ulimit "
            "-u)",
            true};
    if (end->finished() && end->text.empty()) return {};
    Trial trial{end->finished() ? end->text : fmt::format("{} {}", format.codec->name, end->text), false};
    const bool hangs = end->outcome == ChildEnd::Outcome::kTimedOut;
    if (format.codec->is_hardware) return trial;  // it is the device that is missing
    if (data_left()) {
        trial.failure +=
            "; the limit on data may be the reason: raise it (ulimit -d), or choose a smaller size";
        trial.is_temporary = true;
    } else if (left) {
        trial.failure += fmt::format(
            "; {} KiB of address space are left (ulimit -v){}: raise the limit, or choose a smaller size",
            *left >> 10U,
            kept_bytes == 0 ? "" : fmt::format(", and drawing needs some {}", kept_bytes >> 10U));
        trial.is_temporary = true;
    } else if (!starts_threads()) {
        trial.failure +=
            "; the system starts no further threads: run fewer processes, or raise the limit (ulimit -u)";
        trial.is_temporary = true;
    } else if (hangs) {
        trial.failure += "; try again on a less busy machine, or another codec";
        trial.is_temporary = true;
    }
    return trial;
}

Trial reason_of(const Ending& ending, const Codec& codec) {
    VideoDef def;
    def.fps = FrameRate(Rational{50, 1});
    def.encoder.codec = ending.kind == FileKind::kAnimation ? "" : codec.name;
    def = small_video(def);
    const std::string name = ending.kind == FileKind::kStream ? "-" : std::string("a") + ending.text;
    std::optional<Format> format;
    try {
        format = find_format(name, def);
    } catch (const Error& error) {
        return {error.what(), false};
    }
    if (codec.is_built_in) return {};
    Trial trial = has_other_threads() ? Trial{encode_one(*format, def)} : try_encoder(*format, def, 0);
    if (!trial.failure.empty()) return trial;
    if (*ending.muxer != '\0' && av_guess_format(ending.muxer, nullptr, nullptr) == nullptr)
        return {"this libavformat does not write " + std::string(ending.words)};
    return {};
}

}  // namespace

std::vector<EncoderProbe> probe_encoders() {
    std::vector<EncoderProbe> probes;
    for (const Ending& ending : endings()) {
        for (const char* const name : ending.codecs) {
            if (name == nullptr) continue;
            const auto [reason, is_temporary] = reason_of(ending, *find_codec(name));
            probes.push_back({ending.text, name, reason.empty(), is_temporary, reason});
        }
    }
    return probes;
}

void check_encoder_starts(const Format& format, const VideoDef& def) {
    if (format.codec->is_hardware || format.codec->is_built_in) return;
    if (has_other_threads()) {
        const std::string lack = lack_of_threads(*format.codec);
        if (lack.empty()) return;
        throw Error(ExitCode::kTemporary, lack);
    }
    const Trial trial = try_encoder(format, def, kDrawingBytes);
    if (trial.failure.empty()) return;
    throw Error(trial.is_temporary ? ExitCode::kTemporary : ExitCode::kEncoder, trial.failure);
}

}  // namespace corda::media
