#include "corda/media/open_mp4.hpp"

#include "corda/core/image.hpp"

namespace corda::media {
namespace {

constexpr int kDecoderThreads = 2;
// A decoder aligns the sides of its frames, at most to multiples of this.
constexpr std::int64_t kLargestAlignment = 64;

/// libav's own allocation of a frame, which also notes a lack of memory.
int get_buffer(AVCodecContext* context, AVFrame* frame, int flags) {
    const int status = avcodec_default_get_buffer2(context, frame, flags);
    if (status == AVERROR(ENOMEM)) *static_cast<std::atomic<bool>*>(context->opaque) = true;
    return status;
}

/// Opens a decoder for the file's track. Returns libav's status.
int open_decoder(OpenMp4& file, const AVCodec* codec, int threads) {
    file.context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "a decoder");
    AVCodecContext& context = *file.context;
    check_libav(avcodec_parameters_to_context(&context, file.stream->codecpar), ExitCode::kIo,
                "the codec parameters are broken");
    context.thread_count = threads;
    context.opaque = file.lacks_memory.get();
    context.get_buffer2 = get_buffer;
    context.pkt_timebase = file.stream->time_base;
    context.max_pixels = kMostPicturePx + kLargestAlignment * kLargestSidePx;
    // A damaged picture is an error; libav would conceal it.
    context.err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    return avcodec_open2(&context, codec, nullptr);
}

}  // namespace

OpenMp4 open_mp4(const std::string& path) {
    const LogCapture log;
    OpenMp4 file;
    AVFormatContext* format = nullptr;
    // The format is named, because libav by itself would take a text file for ANSI art, or follow a playlist.
    const AVInputFormat* mov = av_find_input_format("mov");
    check_libav(avformat_open_input(&format, file_url(path).c_str(), mov, nullptr), ExitCode::kIo,
                "the file does not open");
    file.format.reset(format);
    const AVCodec* codec = nullptr;
    const int index = check_libav(av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0),
                                  ExitCode::kIo, "there is no video track that can be decoded");
    file.stream = format->streams[index];
    int status = open_decoder(file, codec, kDecoderThreads);
    // The system starts no further thread; one is enough.
    if (status == AVERROR(EAGAIN)) status = open_decoder(file, codec, 1);
    check_libav(status, ExitCode::kIo, "the decoder does not open");
    return file;
}

}  // namespace corda::media
