#include <array>
#include <cstdlib>
#include <cstring>

#include "corda/media/libav_handles.hpp"
#include "corda/media/video_writer.hpp"

namespace corda::media {
namespace {

// Large enough for every encoder's minimum (nvenc: 145x49), small enough to open at once.
constexpr int kProbeWidth = 320;
constexpr int kProbeHeight = 192;

struct ProbedEncoder {
    const char* name;
    const char* option;  ///< that silences a library which prints past libav, or keeps it small; may be null
    const char* value;
};

constexpr std::array<ProbedEncoder, 12> kEncoders{{
    {"libx264", nullptr, nullptr},
    {"libx265", "x265-params", "log-level=none"},
    {"libsvtav1", "svtav1-params", "lp=1:preset=12"},
    {"libvpx-vp9", nullptr, nullptr},
    {"prores_ks", nullptr, nullptr},
    {"ffv1", nullptr, nullptr},
    {"gif", nullptr, nullptr},
    {"apng", nullptr, nullptr},
    {"libwebp_anim", nullptr, nullptr},
    {"png", nullptr, nullptr},
    {"h264_nvenc", nullptr, nullptr},
    {"h264_vaapi", nullptr, nullptr},
}};

std::string reason_of(int status, const LogCapture& log) {
    return log.text().empty() ? libav_text(status) : libav_text(status) + " (" + log.text() + ")";
}

/// VA-API encodes pictures on the device only, so it needs a device and a pool of frames there.
int attach_vaapi(AVCodecContext& context) {
    AVBufferRef* device = nullptr;
    int status = av_hwdevice_ctx_create(&device, AV_HWDEVICE_TYPE_VAAPI, nullptr, nullptr, 0);
    if (status < 0) return status;
    const BufferRef device_ref(device);
    BufferRef frames(av_hwframe_ctx_alloc(device));
    if (!frames) return AVERROR(ENOMEM);
    auto* pool = reinterpret_cast<AVHWFramesContext*>(frames->data);
    pool->format = AV_PIX_FMT_VAAPI;
    pool->sw_format = AV_PIX_FMT_NV12;
    pool->width = kProbeWidth;
    pool->height = kProbeHeight;
    status = av_hwframe_ctx_init(frames.get());
    if (status >= 0) context.hw_frames_ctx = frames.release();
    return status;
}

/// Encodes one picture and ends the stream. An encoder that opens may still refuse its first picture, and
/// SVT-AV1 1.4 never returns from its close call when it has not seen the end of a stream.
int encode_one(AVCodecContext& context) {
    const Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    frame->format = context.pix_fmt;
    frame->width = context.width;
    frame->height = context.height;
    frame->pts = 0;
    int status = av_frame_get_buffer(frame.get(), 0);
    if (status < 0) return status;
    for (int plane = 0; plane < AV_NUM_DATA_POINTERS && frame->buf[plane] != nullptr; ++plane) {
        std::memset(frame->buf[plane]->data, 0, frame->buf[plane]->size);
    }
    const int sent = avcodec_send_frame(&context, frame.get());
    const int ended = avcodec_send_frame(&context, nullptr);
    for (status = 0; status >= 0;) {
        status = avcodec_receive_packet(&context, packet.get());
        if (status >= 0) av_packet_unref(packet.get());
    }
    if (sent < 0) return sent;
    return ended < 0 ? ended : status == AVERROR_EOF ? 0 : status;
}

EncoderProbe probe(const ProbedEncoder& encoder) {
    LogCapture log;
    const AVCodec* codec = avcodec_find_encoder_by_name(encoder.name);
    if (codec == nullptr) return {encoder.name, false, "this libavcodec was built without it"};
    const CodecContext context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "an encoder");
    context->width = kProbeWidth;
    context->height = kProbeHeight;
    context->time_base = {1, 30};
    context->framerate = {30, 1};
    context->pix_fmt = codec->pix_fmts == nullptr ? AV_PIX_FMT_YUV420P : codec->pix_fmts[0];
    context->thread_count = 1;
    if (context->pix_fmt == AV_PIX_FMT_VAAPI) {
        if (const int status = attach_vaapi(*context); status < 0)
            return {encoder.name, false, reason_of(status, log)};
    }
    Options options;
    if (encoder.option != nullptr) options.set(encoder.option, encoder.value);
    int status = avcodec_open2(context.get(), codec, options.get());
    if (status >= 0 && context->hw_frames_ctx == nullptr) status = encode_one(*context);
    if (status < 0) return {encoder.name, false, reason_of(status, log)};
    return {encoder.name, true, ""};
}

}  // namespace

std::vector<EncoderProbe> probe_encoders() {
    // SVT-AV1 prints to stderr by itself and listens to nothing but this; a user's own setting stays.
    ::setenv("SVT_LOG", "0", 0);
    std::vector<EncoderProbe> probes;
    probes.reserve(kEncoders.size());
    for (const ProbedEncoder& encoder : kEncoders) probes.push_back(probe(encoder));
    return probes;
}

}  // namespace corda::media
