#include "corda/media/read/decoder.hpp"

#include <string_view>

#include <fmt/format.h>

#include "corda/core/image.hpp"
#include "corda/media/format/file_kind.hpp"

namespace corda::media {
namespace {

constexpr int kDecoderThreads = 2;
// A decoder aligns the sides of its frames, at most to multiples of this.
constexpr std::int64_t kMaxAlignment = 64;

/// libav's own allocation of a frame, which also notes a lack of memory.
int get_buffer(AVCodecContext* context, AVFrame* frame, int flags) {
    const int status = avcodec_default_get_buffer2(context, frame, flags);
    if (status == AVERROR(ENOMEM)) *static_cast<std::atomic<bool>*>(context->opaque) = true;
    return status;
}

/// libav's own decoder of VP9 leaves alpha out.
const AVCodec* with_alpha(const AVStream& stream, const AVCodec* codec) {
    if (stream.codecpar->codec_id != AV_CODEC_ID_VP9 || !is_marked_as_alpha(stream)) return codec;
    const AVCodec* const better = avcodec_find_decoder_by_name("libvpx-vp9");
    return better == nullptr ? codec : better;
}

}  // namespace

bool is_marked_as_alpha(const AVStream& stream) {
    const AVDictionaryEntry* const entry = av_dict_get(stream.metadata, "alpha_mode", nullptr, 0);
    return entry != nullptr && std::string_view(entry->value) == "1";
}

std::string metadata_entry(const AVFormatContext& format, const char* key) {
    const AVDictionaryEntry* entry = av_dict_get(format.metadata, key, nullptr, 0);
    return entry == nullptr ? std::string() : std::string(entry->value);
}

Decoder::Decoder(std::string path) : path_(std::move(path)) {
    const LogCapture log;
    const std::string kind = file_kind(path_);
    const AVInputFormat* demuxer = kind.empty() ? nullptr : av_find_input_format(kind.c_str());
    if (demuxer == nullptr) {
        const ForeignKind* const foreign = foreign_kind_of(path_);
        throw Error(ExitCode::kIo,
                    foreign == nullptr
                        ? fmt::format("'{}' is no video of a kind that is known", path_)
                        : fmt::format("'{}' is {}: {}", path_, foreign->words, foreign->remedy));
    }
    AVFormatContext* format = nullptr;
    check_libav(avformat_open_input(&format, file_url(path_).c_str(), demuxer, nullptr), ExitCode::kIo,
                fmt::format("'{}' does not open", path_));
    format_.reset(format);
    const AVCodec* codec = nullptr;
    const int index =
        check_libav(av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0), ExitCode::kIo,
                    fmt::format("'{}' has no video track that can be decoded", path_));
    stream_ = format->streams[index];
    codec = with_alpha(*stream_, codec);
    // That a slice of FFV1 is damaged stands only in the log of the thread that decodes it, and a LogCapture
    // has that of its own thread.
    const bool reports_by_log = stream_->codecpar->codec_id == AV_CODEC_ID_FFV1;
    int status = open(codec, reports_by_log ? 1 : kDecoderThreads);
    // The system starts no further thread; one is enough.
    if (status == AVERROR(EAGAIN)) status = open(codec, 1);
    check_libav(status, ExitCode::kIo, fmt::format("the decoder of '{}' does not open", path_));
    packet_ = check_allocated(Packet(av_packet_alloc()), "a packet");
    frame_ = check_allocated(Frame(av_frame_alloc()), "a frame");
}

int Decoder::open(const AVCodec* codec, int threads) {
    context_ = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "a decoder");
    check_libav(avcodec_parameters_to_context(context_.get(), stream_->codecpar), ExitCode::kIo,
                "the codec parameters are broken");
    context_->thread_count = threads;
    context_->opaque = lacks_memory_.get();
    context_->get_buffer2 = get_buffer;
    context_->pkt_timebase = stream_->time_base;
    context_->max_pixels = kMaxPicturePx + kMaxAlignment * kMaxSidePx;
    // A damaged picture is an error; libav would conceal it.
    context_->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    return avcodec_open2(context_.get(), codec, nullptr);
}

int Decoder::feed(const std::function<PacketUse(const AVPacket&)>& use) {
    int status = av_read_frame(format_.get(), packet_.get());
    if (status < 0) {
        is_alone_ = false;
        is_drain_due_ = true;
        return status == AVERROR_EOF ? 0 : status;
    }
    if (packet_->stream_index == stream_->index) {
        const PacketUse wanted = use ? use(*packet_) : PacketUse::kDecode;
        has_input_ = wanted != PacketUse::kSkip;
        is_alone_ = wanted == PacketUse::kDecodeAlone;
        if (has_input_) status = avcodec_send_packet(context_.get(), packet_.get());
    }
    av_packet_unref(packet_.get());
    return status;
}

int Decoder::next(LogCapture& log, const std::function<PacketUse(const AVPacket&)>& use) {
    constexpr int kMaxDrainErrors = 1000;
    for (;;) {
        int status = 0;
        if (is_drain_due_) {
            status = avcodec_send_packet(context_.get(), nullptr);
            is_drain_due_ = false;
            has_input_ = is_draining_ = true;
            drain_errors_ = 0;
        } else if (!has_input_) {
            log.clear();
            status = feed(use);
        }
        if (status < 0) return status;  // sending decodes, too
        if (!has_input_) continue;
        status = avcodec_receive_frame(context_.get(), frame_.get());
        if (status == 0) return 0;
        // While draining, each bad frame has an error of its own; otherwise a packet is due.
        if (is_draining_ && status != AVERROR_EOF && ++drain_errors_ <= kMaxDrainErrors) return status;
        if (is_draining_ && !is_alone_) return AVERROR_EOF;
        if (is_draining_) avcodec_flush_buffers(context_.get());
        is_drain_due_ = is_alone_ && !is_draining_;
        has_input_ = is_draining_ = false;
        if (status != AVERROR(EAGAIN) && status != AVERROR_EOF) return status;
    }
}

bool Decoder::read() {
    LogCapture log;
    const int status = next(log);
    if (status == AVERROR_EOF) return false;
    if (status < 0) fail(status);
    if (frame_->decode_error_flags != 0) fail(AVERROR_INVALIDDATA);
    return true;
}

void Decoder::fail(int status) const {
    fail_libav(ExitCode::kIo, fmt::format("{}: decoding failed", path_), status);
}

}  // namespace corda::media
