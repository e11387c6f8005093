#include "corda/media/read/open_video.hpp"

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

/// Opens a decoder for the file's track. Returns libav's status.
int open_decoder(OpenVideo& file, const AVCodec* codec, int threads) {
    file.context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "a decoder");
    AVCodecContext& context = *file.context;
    check_libav(avcodec_parameters_to_context(&context, file.stream->codecpar), ExitCode::kIo,
                "the codec parameters are broken");
    context.thread_count = threads;
    context.opaque = file.lacks_memory.get();
    context.get_buffer2 = get_buffer;
    context.pkt_timebase = file.stream->time_base;
    context.max_pixels = kMaxPicturePx + kMaxAlignment * kMaxSidePx;
    // A damaged picture is an error; libav would conceal it.
    context.err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    return avcodec_open2(&context, codec, nullptr);
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

OpenVideo open_video(const std::string& path, std::optional<std::uint64_t> bytes) {
    const LogCapture log;
    OpenVideo file;
    AVFormatContext* format = nullptr;
    const std::string kind = file_kind(path);
    const AVInputFormat* demuxer = kind.empty() ? nullptr : av_find_input_format(kind.c_str());
    if (demuxer == nullptr) {
        const ForeignKind* const foreign = foreign_kind_of(path);
        throw Error(ExitCode::kIo,
                    foreign == nullptr
                        ? fmt::format("'{}' is no video of a kind that is known", path)
                        : fmt::format("'{}' is {}: {}", path, foreign->words, foreign->remedy));
    }
    const std::string url = bytes ? file_url(path, *bytes) : file_url(path);
    check_libav(avformat_open_input(&format, url.c_str(), demuxer, nullptr), ExitCode::kIo,
                fmt::format("'{}' does not open", path));
    file.format.reset(format);
    const AVCodec* codec = nullptr;
    const int index =
        check_libav(av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0), ExitCode::kIo,
                    fmt::format("'{}' has no video track that can be decoded", path));
    file.stream = format->streams[index];
    codec = with_alpha(*file.stream, codec);
    // That a slice of FFV1 is damaged stands in the log alone, of whichever thread decodes it, and a
    // LogCapture has that of its own thread.
    const bool tells_by_log = file.stream->codecpar->codec_id == AV_CODEC_ID_FFV1;
    int status = open_decoder(file, codec, tells_by_log ? 1 : kDecoderThreads);
    // The system starts no further thread; one is enough.
    if (status == AVERROR(EAGAIN)) status = open_decoder(file, codec, 1);
    check_libav(status, ExitCode::kIo, fmt::format("the decoder of '{}' does not open", path));
    return file;
}

}  // namespace corda::media
