#include "corda/media/open_mp4.hpp"

namespace corda::media {
namespace {

constexpr int kDecoderThreads = 2;

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
    file.context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "a decoder");
    check_libav(avcodec_parameters_to_context(file.context.get(), file.stream->codecpar), ExitCode::kIo,
                "the codec parameters are broken");
    file.context->thread_count = kDecoderThreads;
    file.context->pkt_timebase = file.stream->time_base;
    // A damaged picture is an error; libav would conceal it.
    file.context->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    check_libav(avcodec_open2(file.context.get(), codec, nullptr), ExitCode::kIo,
                "the decoder does not open");
    return file;
}

}  // namespace corda::media
