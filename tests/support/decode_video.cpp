#include "support/decode_video.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavcodec/bsf.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <cstring>
#include <memory>
#include <stdexcept>

namespace corda::test {
namespace {

void check(int status, const char* what) {
    if (status < 0) throw std::runtime_error(what);
}

struct CloseInput {
    void operator()(AVFormatContext* c) const { avformat_close_input(&c); }
};
struct FreeCodec {
    void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
};
struct FreeFilter {
    void operator()(AVBSFContext* c) const { av_bsf_free(&c); }
};
struct FreeFrame {
    void operator()(AVFrame* f) const { av_frame_free(&f); }
};
struct FreePacket {
    void operator()(AVPacket* p) const { av_packet_free(&p); }
};
using Input = std::unique_ptr<AVFormatContext, CloseInput>;

Input open_input(const std::string& path) {
    AVFormatContext* raw = nullptr;
    check(avformat_open_input(&raw, path.c_str(), nullptr, nullptr), "open");
    return Input(raw);
}

Yuv420Image picture_of(const AVFrame& frame) {
    if (frame.format != AV_PIX_FMT_YUV420P) throw std::runtime_error("not yuv420p");
    Yuv420Image picture(frame.width, frame.height);
    for (int plane = 0; plane < 3; ++plane) {
        const auto width = static_cast<std::size_t>(picture.plane_width(plane));
        for (int row = 0; row < picture.plane_height(plane); ++row) {
            std::memcpy(picture.plane(plane) + static_cast<std::size_t>(row) * width,
                        frame.data[plane] + static_cast<std::ptrdiff_t>(row) * frame.linesize[plane], width);
        }
    }
    return picture;
}

void take_frames(AVCodecContext& context, AVFrame& frame, DecodedFrames& out) {
    while (avcodec_receive_frame(&context, &frame) == 0) {
        out.pts.push_back(frame.pts);
        out.pictures.push_back(picture_of(frame));
        out.range = frame.color_range;
        out.matrix = frame.colorspace;
        out.primaries = frame.color_primaries;
        out.transfer = frame.color_trc;
        out.chroma_location = frame.chroma_location;
        av_frame_unref(&frame);
    }
}

}  // namespace

DecodedFrames decode_video(const std::string& path) {
    const Input input = open_input(path);
    check(avformat_find_stream_info(input.get(), nullptr), "stream info");
    const AVStream* stream = input->streams[0];
    const AVCodec* codec = avcodec_find_decoder(stream->codecpar->codec_id);
    const std::unique_ptr<AVCodecContext, FreeCodec> context(avcodec_alloc_context3(codec));
    check(avcodec_parameters_to_context(context.get(), stream->codecpar), "parameters");
    check(avcodec_open2(context.get(), codec, nullptr), "decoder");
    const std::unique_ptr<AVFrame, FreeFrame> frame(av_frame_alloc());
    const std::unique_ptr<AVPacket, FreePacket> packet(av_packet_alloc());
    DecodedFrames out;
    out.tick_num = stream->time_base.num;
    out.tick_den = stream->time_base.den;
    while (av_read_frame(input.get(), packet.get()) >= 0) {
        check(avcodec_send_packet(context.get(), packet.get()), "packet");
        av_packet_unref(packet.get());
        take_frames(*context, *frame, out);
    }
    check(avcodec_send_packet(context.get(), nullptr), "drain");
    take_frames(*context, *frame, out);
    out.stream_duration = stream->duration;
    out.container_duration_us = input->duration;
    return out;
}

void copy_video(const std::string& from, const std::string& to, Retag retag) {
    const Input input = open_input(from);
    const AVStream* source = input->streams[0];
    AVBSFContext* raw_filter = nullptr;
    check(av_bsf_alloc(av_bsf_get_by_name("h264_metadata"), &raw_filter), "filter");
    const std::unique_ptr<AVBSFContext, FreeFilter> filter(raw_filter);
    check(avcodec_parameters_copy(filter->par_in, source->codecpar), "filter parameters");
    if (retag == Retag::kStream) {
        check(av_opt_set_int(filter->priv_data, "matrix_coefficients", AVCOL_SPC_SMPTE170M, 0), "matrix");
        check(av_opt_set_int(filter->priv_data, "transfer_characteristics", AVCOL_TRC_BT709, 0), "transfer");
    }
    check(av_bsf_init(filter.get()), "filter start");

    AVFormatContext* raw = nullptr;
    check(avformat_alloc_output_context2(&raw, nullptr, "mp4", to.c_str()), "muxer");
    const std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)> output(raw, avformat_free_context);
    AVStream* stream = avformat_new_stream(raw, nullptr);
    check(avcodec_parameters_copy(stream->codecpar, filter->par_out), "copy");
    stream->codecpar->codec_tag = 0;
    stream->time_base = source->time_base;
    if (retag == Retag::kContainer) {
        stream->codecpar->color_space = AVCOL_SPC_SMPTE170M;
        stream->codecpar->color_trc = AVCOL_TRC_BT709;
    }
    check(avio_open(&raw->pb, to.c_str(), AVIO_FLAG_WRITE), "create");
    check(avformat_write_header(raw, nullptr), "header");
    const std::unique_ptr<AVPacket, FreePacket> packet(av_packet_alloc());
    while (av_read_frame(input.get(), packet.get()) >= 0) {
        check(av_bsf_send_packet(filter.get(), packet.get()), "filter packet");
        check(av_bsf_receive_packet(filter.get(), packet.get()), "filtered packet");
        av_packet_rescale_ts(packet.get(), source->time_base, stream->time_base);
        check(av_write_frame(raw, packet.get()), "write");
        av_packet_unref(packet.get());
    }
    check(av_write_trailer(raw), "trailer");
    check(avio_closep(&raw->pb), "close");
}

}  // namespace corda::test
