#include "corda/media/chunks/chunk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/media/read/color_patch.hpp"

namespace corda::media {

std::int64_t frames_per_chunk(const FrameRate& fps) {
    constexpr double kFrames = 60.0;
    const double per_second = fps.rational().value();
    return std::max<std::int64_t>(1, std::llround(std::clamp(kFrames, per_second, 2.0 * per_second)));
}

std::int64_t frames_per_chunk(const Format& format, const FrameRate& fps) {
    const std::int64_t most = frames_per_chunk(fps);
    return format.codec->chunk_frames > 0 ? std::min<std::int64_t>(format.codec->chunk_frames, most) : most;
}

ChunkEncoder::ChunkEncoder(std::unique_ptr<Encoder> encoder) : encoder_(std::move(encoder)) {}

void ChunkEncoder::keep(AVPacket& packet) {
    Packet kept = check_allocated(Packet(av_packet_alloc()), "a packet");
    av_packet_move_ref(kept.get(), &packet);
    chunk_.packets.push_back(std::move(kept));
}

void ChunkEncoder::encode(const Image& frame, const Damage& damage, bool is_last) {
    assert(encoder_);
    if (chunk_.frames == 0 || is_last) chunk_.colors.push_back({chunk_.frames, choose_patches(frame)});
    if (is_last) encoder_->expect(chunk_.colors.back().patches);
    encoder_->encode(frame, damage, [this](AVPacket& packet) { keep(packet); });
    ++chunk_.frames;
}

Chunk ChunkEncoder::finish(std::function<bool()> goes_on) {
    assert(encoder_);
    const CancelScope alone(std::move(goes_on), CancelScope::Outer::kIgnored);
    if (chunk_.frames > 0) {
        encoder_->drain([&](AVPacket& packet) {
            check_cancelled();
            keep(packet);
        });
        chunk_.parameters = check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
        check_libav(avcodec_parameters_copy(chunk_.parameters.get(), &encoder_->parameters()),
                    ExitCode::kEncoder, "cannot copy codec parameters");
    }
    encoder_.reset();
    return std::move(chunk_);
}

}  // namespace corda::media
