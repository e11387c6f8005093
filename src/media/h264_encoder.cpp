#include "corda/media/h264_encoder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <limits>

#include "corda/core/error.hpp"

namespace corda::media {
namespace {

constexpr int kLargestSide = 16384;
constexpr std::int64_t kLargestPicture = std::int64_t{1} << 26;
constexpr int kLargestCrf = 51;
constexpr int kMostThreads = 64;
constexpr double kKeyFrameIntervalS = 2.0;  // an interrupted run loses at most this much

template <typename... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> text, Args&&... args) {
    throw Error(ExitCode::kUsage, fmt::format(text, std::forward<Args>(args)...));
}

/// The two even numbers around an odd side: "1080 or 1082".
std::string even_sides(int side) {
    return side % 2 == 0 ? std::to_string(side)
           : side == 1   ? std::string("2")
                         : fmt::format("{} or {}", side - 1, side + 1);
}

void check_size(int width, int height) {
    if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide ||
        std::int64_t{width} * height > kLargestPicture) {
        fail_usage(
            "video size {}x{} is out of range: each side is 2 to {}, and a frame has at most {} pixels",
            width, height, kLargestSide, kLargestPicture);
    }
    if (width % 2 == 0 && height % 2 == 0) return;
    fail_usage(
        "video size {}x{} is odd, and H.264 4:2:0 needs even sides; use a width of {} and a height of {}",
        width, height, even_sides(width), even_sides(height));
}

const AVCodec* find_x264() {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec != nullptr) return codec;
    throw Error(ExitCode::kEncoder,
                "this libavcodec was built without libx264; install one that has it (Debian: apt-get install "
                "libavcodec59 libx264-164), and see `corda doctor`");
}

void set_colors(AVCodecContext& context) {
    context.color_range = AVCOL_RANGE_MPEG;
    context.colorspace = AVCOL_SPC_BT709;
    context.color_primaries = AVCOL_PRI_BT709;
    // The bt709 transfer tag would be truer to the matrix and wrong on the screen: Safari and QuickTime wash
    // it out.
    context.color_trc = AVCOL_TRC_IEC61966_2_1;
    context.chroma_sample_location = AVCHROMA_LOC_LEFT;
}

void configure(AVCodecContext& context, const VideoDef& def) {
    const Rational fps = def.fps.rational();
    context.width = def.width_px;
    context.height = def.height_px;
    context.pix_fmt = AV_PIX_FMT_YUV420P;
    context.sample_aspect_ratio = {1, 1};
    context.time_base = frame_time_base(fps);
    context.framerate = to_libav(fps);
    context.profile = FF_PROFILE_H264_HIGH;
    context.gop_size = static_cast<int>(std::clamp(kKeyFrameIntervalS * fps.value(), 1.0, 1e6));
    context.thread_count = def.encoder.threads;
    context.flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
    set_colors(context);
}

/// profile_idc of the sequence parameter set in Annex B extradata; -1 where there is none.
int profile_idc(const AVCodecContext& context) {
    const std::uint8_t* data = context.extradata;
    for (int i = 0; i + 4 < context.extradata_size; ++i) {
        const bool start_code = data[i] == 0 && data[i + 1] == 0 && data[i + 2] == 1;
        if (start_code && (data[i + 3] & 0x1f) == 7) return data[i + 4];
    }
    return -1;
}

/// Browsers and QuickTime play 8-bit 4:2:0 only, and x264 may choose otherwise without a word.
void check_playable(const AVCodecContext& context) {
    const int idc = profile_idc(context);
    const bool playable_profile =
        idc == FF_PROFILE_H264_BASELINE || idc == FF_PROFILE_H264_MAIN || idc == FF_PROFILE_H264_HIGH;
    if (context.pix_fmt == AV_PIX_FMT_YUV420P && playable_profile) return;
    const char* format = av_get_pix_fmt_name(context.pix_fmt);
    throw Error(
        ExitCode::kEncoder,
        fmt::format("libx264 chose pixel format {} and profile_idc {}, which browsers and QuickTime refuse; "
                    "use crf 1 to {} and no option that changes the profile",
                    format == nullptr ? "unknown" : format, idc, kLargestCrf));
}

struct OwnedPicture {
    Yuv420Image* picture;
    BufferRef ref;
};

OwnedPicture own_picture(std::unique_ptr<Yuv420Image> picture) {
    const auto release = [](void* opaque, std::uint8_t*) { delete static_cast<Yuv420Image*>(opaque); };
    const std::size_t luma_bytes = static_cast<std::size_t>(picture->width()) * picture->height();
    BufferRef ref =
        check_allocated(BufferRef(av_buffer_create(picture->plane(0), luma_bytes, release, picture.get(), 0)),
                        "a picture buffer");
    return {picture.release(), std::move(ref)};
}

}  // namespace

void check_video_def(const VideoDef& def) {
    const EncoderDef& encoder = def.encoder;
    check_size(def.width_px, def.height_px);
    const Rational fps = def.fps.rational();
    if (fps.num < 1 || fps.den < 1 || fps.num > 1'000'000'000 || fps.den > 1'000'000'000) {
        fail_usage("frame rate {} is out of range; use a positive rate such as 60 or 30000/1001", fps.text());
    }
    if (encoder.codec != "libx264") fail_usage("unknown codec '{}'; use libx264", encoder.codec);
    const auto& presets = x264_presets();
    if (std::find(presets.begin(), presets.end(), encoder.preset) == presets.end()) {
        fail_usage("unknown preset '{}'; use one of {}", encoder.preset, fmt::join(presets, ", "));
    }
    if (encoder.crf < 1 || encoder.crf > kLargestCrf) {
        fail_usage("crf {} is out of range; use 1 to {} (0 is lossless 4:4:4, which browsers refuse)",
                   encoder.crf, kLargestCrf);
    }
    if (encoder.threads < 1 || encoder.threads > kMostThreads) {
        fail_usage("{} encoder threads are out of range; use 1 to {}", encoder.threads, kMostThreads);
    }
}

H264Encoder::H264Encoder(const VideoDef& def) {
    const LogCapture log;
    const AVCodec* codec = find_x264();
    context_ = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "an encoder");
    configure(*context_, def);
    Options options;
    options.set("preset", def.encoder.preset).set("crf", std::to_string(def.encoder.crf));
    check_libav(avcodec_open2(context_.get(), codec, options.get()), ExitCode::kEncoder,
                fmt::format("libx264 does not open for {}x{} at {} fps, preset {}, crf {}", def.width_px,
                            def.height_px, def.fps.rational().text(), def.encoder.preset, def.encoder.crf),
                "try another preset or size");
    if (const std::string name = options.left_over(); !name.empty()) {
        throw Error(ExitCode::kEncoder, fmt::format("libx264 does not know the option '{}'", name));
    }
    check_playable(*context_);
    parameters_.reset(check_allocated(avcodec_parameters_alloc(), "codec parameters"));
    check_libav(avcodec_parameters_from_context(parameters_.get(), context_.get()), ExitCode::kEncoder,
                "cannot read the encoder's parameters");
    packet_ = check_allocated(Packet(av_packet_alloc()), "a packet");
    auto [picture, ref] = own_picture(std::make_unique<Yuv420Image>(def.width_px, def.height_px));
    picture_ = picture;
    picture_ref_ = std::move(ref);
}

void H264Encoder::make_picture_writable() {
    if (av_buffer_get_ref_count(picture_ref_.get()) == 1) return;
    auto [picture, ref] = own_picture(std::make_unique<Yuv420Image>(*picture_));
    picture_ = picture;
    picture_ref_ = std::move(ref);
}

void H264Encoder::encode(const Image& frame, const PixelRect& damage, const PacketSink& sink) {
    assert(frame.width() == picture_->width() && frame.height() == picture_->height());
    const LogCapture log;
    const PixelRect changed = frames_ == 0 ? frame.rect() : damage.intersected(frame.rect());
    if (!changed.empty()) {
        make_picture_writable();
        convert_to_yuv420(frame, changed, *picture_);
    }
    const Frame av_frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    av_frame->format = AV_PIX_FMT_YUV420P;
    av_frame->width = picture_->width();
    av_frame->height = picture_->height();
    av_frame->sample_aspect_ratio = {1, 1};
    av_frame->pts = frames_;
    av_frame->pkt_duration = 1;
    av_frame->color_range = context_->color_range;
    av_frame->colorspace = context_->colorspace;
    av_frame->color_primaries = context_->color_primaries;
    av_frame->color_trc = context_->color_trc;
    av_frame->chroma_location = context_->chroma_sample_location;
    for (int index = 0; index < 3; ++index) {
        av_frame->data[index] = picture_->plane(index);
        av_frame->linesize[index] = picture_->plane_width(index);
    }
    av_frame->buf[0] = check_allocated(av_buffer_ref(picture_ref_.get()), "a picture reference");
    send(av_frame.get(), sink);
    ++frames_;
}

void H264Encoder::drain(const PacketSink& sink) {
    const LogCapture log;
    send(nullptr, sink);
}

void H264Encoder::send(const AVFrame* frame, const PacketSink& sink) {
    check_libav(avcodec_send_frame(context_.get(), frame), ExitCode::kEncoder,
                fmt::format("libx264 refused frame {}", frames_));
    for (;;) {
        const int status = avcodec_receive_packet(context_.get(), packet_.get());
        if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
        check_libav(status, ExitCode::kEncoder, fmt::format("libx264 failed near frame {}", frames_));
        packet_->duration = 1;
        sink(*packet_);
    }
}

}  // namespace corda::media
