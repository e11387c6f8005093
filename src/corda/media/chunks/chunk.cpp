#include "corda/media/chunks/chunk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/read/color_patch.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {
namespace {

/// The parameters of a chunk for a muxer: libaom gives its header with the first packet, not before.
CodecParameters with_header(const Chunk& chunk) {
    CodecParameters parameters =
        check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
    check_libav(avcodec_parameters_copy(parameters.get(), chunk.parameters.get()), ExitCode::kEncoder,
                "cannot copy codec parameters");
    std::size_t bytes = 0;
    const std::uint8_t* const header =
        chunk.packets.empty()
            ? nullptr
            : av_packet_get_side_data(chunk.packets.front().get(), AV_PKT_DATA_NEW_EXTRADATA, &bytes);
    if (header == nullptr || parameters->extradata_size > 0) return parameters;
    parameters->extradata = static_cast<std::uint8_t*>(av_mallocz(bytes + AV_INPUT_BUFFER_PADDING_SIZE));
    if (parameters->extradata == nullptr)
        fail_libav(ExitCode::kTemporary, "cannot copy codec parameters", AVERROR(ENOMEM));
    std::copy_n(header, bytes, parameters->extradata);
    parameters->extradata_size = static_cast<int>(bytes);
    return parameters;
}

}  // namespace

std::int64_t frames_per_chunk(const FrameRate& fps) {
    constexpr double kFrames = 60.0;
    const double per_second = fps.rational().value();
    return std::max<std::int64_t>(1, std::llround(std::clamp(kFrames, per_second, 2.0 * per_second)));
}

std::int64_t frames_per_chunk(const Format& format, const FrameRate& fps) {
    const std::int64_t most = frames_per_chunk(fps);
    return format.codec->chunk_frames > 0 ? std::min<std::int64_t>(format.codec->chunk_frames, most) : most;
}

ChunkEncoder::ChunkEncoder(std::unique_ptr<Encoder> encoder, std::int64_t first)
    : encoder_(std::move(encoder)) {
    chunk_.first = first;
}

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

Chunk ChunkEncoder::finish() {
    assert(encoder_);
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

void write_chunk(const Chunk& chunk, const Format& format, Rational fps, OutputFile& output) {
    const bool is_animation = format.ending->kind == FileKind::kAnimation;
    TrackOutput track(output, is_animation ? "mov" : format.ending->muxer, *with_header(chunk),
                      {.fps = fps,
                       .title = {},
                       .comment = chunk_comment(chunk.colors),
                       .has_alpha = format.has_alpha && chunk.parameters->codec_id == AV_CODEC_ID_VP9});
    for (const Packet& packet : chunk.packets) track.write(*packet);
    track.finish();
}

}  // namespace corda::media
