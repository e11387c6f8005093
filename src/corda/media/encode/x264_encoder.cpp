#include "corda/core/text.hpp"
#include "corda/media/encode/encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

extern "C" {
#include <x264.h>
}

#include "corda/media/encode/pixels.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

constexpr int kMacroblockPx = 16;

using X264 = std::unique_ptr<x264_t, PointerDeleter<&x264_encoder_close>>;

int macroblocks(int side_px) {
    return (side_px + kMacroblockPx - 1) / kMacroblockPx;
}

/// Passes messages of x264 to libav's log.
void on_x264_log(void* /*unused*/, int level, const char* format, va_list arguments) {
    if (level == X264_LOG_ERROR) av_vlog(nullptr, AV_LOG_ERROR, format, arguments);
}

/// The constant rate factor; of a preset that spreads no bits over a frame, a constant quantizer in its
/// place. For the former x264 looks at each frame once more to know how much moves in it: two fifths of the
/// time of ultrafast, which has no other use for it, and macroblocks that stand still are encoded again
/// whenever the quantizer falls. Bytes at the same PSNR are the same. Four below the factor, bytes and PSNR
/// are those of the factor where little moves (first at 18: 499 kB, 60.8 dB for 493 kB, 60.7 dB); where much
/// does, the quality stays (cloth: 6.9 MB, 54.6 dB for 4.5 MB, 48.5 dB).
void set_rate(x264_param_t& params, int crf) {
    constexpr int kQuantizerBelowCrf = 4;
    params.rc.i_rc_method = X264_RC_CRF;
    params.rc.f_rf_constant = static_cast<float>(crf);
    if (params.rc.i_aq_mode != X264_AQ_NONE || params.rc.b_mb_tree != 0) return;
    params.rc.i_rc_method = X264_RC_CQP;
    params.rc.i_qp_constant = std::max(1, crf - kQuantizerBelowCrf);  // 0 would be lossless, which few play
}

/// A key frame at each multiple of the interval, and nowhere else: a drawing has no cuts to be found.
void set_key_frames(x264_param_t& params, int interval) {
    params.i_keyint_max = interval;
    params.i_scenecut_threshold = 0;
}

x264_param_t make_params(const Format& format, const VideoDef& def) {
    x264_param_t params;
    const std::string preset = format.preset_of(def.encoder);
    if (x264_param_default_preset(&params, preset.c_str(), nullptr) < 0)
        throw_error(ExitCode::kEncoder, "libx264 does not know the preset '{}'", preset);
    const Rational fps = def.fps.rational();
    const bool is_420 = std::string_view(format.pixel_format) == "yuv420p";
    params.pf_log = &on_x264_log;
    params.i_log_level = X264_LOG_ERROR;
    // Otherwise the bytes depend on the CPU: SIMD code of the macroblock tree approximates reciprocals, and
    // with AVX-512 it reads uninitialized memory beyond the rows. The plain code takes no measurable time
    // more.
    params.b_cpu_independent = 1;
    params.i_threads = def.encoder.threads;
    params.i_width = def.width_px;
    params.i_height = def.height_px;
    params.i_csp = is_420 ? X264_CSP_I420 : X264_CSP_I444;
    params.vui.i_sar_width = params.vui.i_sar_height = 1;
    params.vui.b_fullrange = 0;
    params.vui.i_colorprim = AVCOL_PRI_BT709;
    params.vui.i_transfer = AVCOL_TRC_IEC61966_2_1;
    params.vui.i_colmatrix = AVCOL_SPC_BT709;
    params.vui.i_chroma_loc = 0;  // left
    params.b_vfr_input = 0;
    params.i_fps_num = static_cast<std::uint32_t>(fps.num);
    params.i_fps_den = static_cast<std::uint32_t>(fps.den);
    set_key_frames(params, key_interval(def.fps));
    params.b_repeat_headers = 0;
    set_rate(params, format.crf_of(def.encoder));
    // B-frames do not pay for motion before a ground that stands still: without them a video takes a
    // quarter less time and 2 to 18 % more bytes at the same PSNR (first 2, cloth 3, whip 10, bridge 18).
    // Frames are stored as they are shown, and the flags of macroblocks mean the frame that x264 refers to.
    params.i_bframe = 0;
    params.analyse.b_mb_info = 1;
    // Of 4:2:0 High (the preset ultrafast gives Constrained Baseline), which browsers and QuickTime play.
    if (x264_param_apply_profile(&params, is_420 ? "high" : "high444") < 0)
        throw_error(ExitCode::kEncoder, "libx264 refuses its profile ({})", captured_log());
    return params;
}

class X264Encoder : public Encoder {
  public:
    X264Encoder(const Format& format, const VideoDef& def)
        : columns_(macroblocks(def.width_px)),
          rows_(macroblocks(def.height_px)),
          pixel_format_(av_get_pix_fmt(format.pixel_format)),
          parameters_(check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters")),
          packet_(check_allocated(Packet(av_packet_alloc()), "a packet")) {
        const LogCapture log;
        x264_param_t params = make_params(format, def);
        x264_.reset(x264_encoder_open(&params));
        if (!x264_) {
            const std::string reason = log.text().empty() ? "" : fmt::format(" ({})", log.text());
            throw_error(ExitCode::kEncoder,
                        "libx264 does not open for {}x{} at {} fps, preset {}, crf {}{}; try another preset, "
                        "size or codec; see `corda doctor`",
                        def.width_px, def.height_px, def.fps.rational().text(), format.preset_of(def.encoder),
                        format.crf_of(def.encoder), reason);
        }
        csp_ = params.i_csp;
        describe(def);
        prime();
    }

    void encode(Frame frame, const Damage& changed, const PacketSink& sink) override {
        x264_picture_t picture;
        x264_picture_init(&picture);
        picture.i_pts = primed_ + frames_;
        picture.i_type = frames_ == 0 ? X264_TYPE_IDR : X264_TYPE_AUTO;
        picture.img.i_csp = csp_;
        picture.img.i_plane = kPlanes;
        for (int plane = 0; plane < kPlanes; ++plane) {
            picture.img.plane[plane] = frame->data[plane];
            picture.img.i_stride[plane] = frame->linesize[plane];
        }
        if (last_) {
            picture.prop.mb_info = constant_macroblocks(*frame, changed);
            picture.prop.mb_info_free = &std::free;
        }
        last_ = std::move(frame);
        encode(&picture, sink);
        ++frames_;
    }

    void drain(const PacketSink& sink) override {
        while (x264_encoder_delayed_frames(x264_.get()) > 0) encode(nullptr, sink);
    }

    [[nodiscard]] const AVCodecParameters& parameters() const override { return *parameters_; }

  private:
    static constexpr int kPlanes = 3;

    /// Fills `parameters_`: all from the definition but the stream's headers. x264's own words (SEI) go
    /// before the first packet, as libavcodec puts them.
    void describe(const VideoDef& def) {
        AVCodecParameters& out = *parameters_;
        out.codec_type = AVMEDIA_TYPE_VIDEO;
        out.codec_id = AV_CODEC_ID_H264;
        out.format = pixel_format_;
        out.width = def.width_px;
        out.height = def.height_px;
        out.sample_aspect_ratio = {1, 1};
        out.color_range = AVCOL_RANGE_MPEG;
        out.color_space = AVCOL_SPC_BT709;
        out.color_primaries = AVCOL_PRI_BT709;
        out.color_trc = AVCOL_TRC_IEC61966_2_1;
        out.chroma_location = chroma_location(pixel_format_);
        x264_nal_t* nals = nullptr;
        int count = 0;
        if (x264_encoder_headers(x264_.get(), &nals, &count) < 0)
            throw Error(ExitCode::kEncoder, "libx264 gives no headers");
        std::string headers;
        for (const x264_nal_t& nal : std::span(nals, static_cast<std::size_t>(count))) {
            const std::string_view bytes(reinterpret_cast<const char*>(nal.p_payload),
                                         static_cast<std::size_t>(nal.i_payload));
            (nal.i_type == NAL_SEI ? sei_ : headers) += bytes;
            constexpr std::size_t kProfile = 5;  // after the start code of four bytes and the type
            if (nal.i_type == NAL_SPS && bytes.size() > kProfile + 2) {
                out.profile = static_cast<unsigned char>(bytes[kProfile]);
                out.level = static_cast<unsigned char>(bytes[kProfile + 2]);
            }
        }
        out.extradata = static_cast<std::uint8_t*>(av_mallocz(headers.size() + AV_INPUT_BUFFER_PADDING_SIZE));
        if (out.extradata == nullptr)
            fail_libav(ExitCode::kTemporary, "cannot keep headers", AVERROR(ENOMEM));
        out.extradata_size = static_cast<int>(headers.size());
        std::copy(headers.begin(), headers.end(), out.extradata);
    }

    /// Encodes grey pictures ahead of the film, whose packets are dropped, so that bytes do not depend on
    /// fresh memory: with flags of macroblocks, x264's deblocking filter (x264_frame_deblock_row) reads the
    /// strength of edges that only macroblocks predicted from another picture write, one for each column and
    /// thread. In a picture that equals the last one, all macroblocks are.
    void prime() {
        x264_param_t params;
        x264_encoder_parameters(x264_.get(), &params);
        const Frame grey = check_allocated(Frame(av_frame_alloc()), "a frame");
        grey->format = pixel_format_;
        grey->width = params.i_width;
        grey->height = params.i_height;
        check_libav(av_frame_get_buffer(grey.get(), 0), ExitCode::kTemporary, "cannot make a picture");
        x264_picture_t picture;
        x264_picture_init(&picture);
        picture.img.i_csp = csp_;
        picture.img.i_plane = kPlanes;
        for (int plane = 0; plane < kPlanes; ++plane) {
            const int lines = params.i_height >> (plane > 0 && csp_ == X264_CSP_I420 ? 1 : 0);
            std::memset(grey->data[plane], 128, static_cast<std::size_t>(grey->linesize[plane]) * lines);
            picture.img.plane[plane] = grey->data[plane];
            picture.img.i_stride[plane] = grey->linesize[plane];
        }
        primed_ = params.i_threads + 1;
        for (picture.i_pts = 0; picture.i_pts < primed_; ++picture.i_pts) {
            picture.i_type = picture.i_pts == 0 ? X264_TYPE_IDR : X264_TYPE_P;
            encode(&picture, {});
        }
    }

    /// A flag for each macroblock, from malloc(): whether its samples are those of the last frame, from which
    /// the frame differs within `changed` at most. By samples, not by damage, so that the bytes of a video do
    /// not depend on how its frames are drawn.
    [[nodiscard]] std::uint8_t* constant_macroblocks(const AVFrame& frame, const Damage& changed) const {
        const std::size_t count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
        std::unique_ptr<std::uint8_t, void (*)(void*)> flags(static_cast<std::uint8_t*>(std::malloc(count)),
                                                             &std::free);
        if (!flags) throw Error(ExitCode::kTemporary, "out of memory for an encoder's flags");
        std::memset(flags.get(), X264_MBINFO_CONSTANT, count);
        for (const PixelRect& part : changed) {
            // A chroma sample takes from the column before it, too.
            const int end = std::min(macroblocks(part.x1 + 1), columns_);
            for (int y = std::max(0, part.y0 / kMacroblockPx); y < std::min(macroblocks(part.y1), rows_); ++y)
                for (int x = std::max(0, part.x0 / kMacroblockPx); x < end; ++x)
                    if (!is_constant(frame, x, y)) flags.get()[std::ptrdiff_t{y} * columns_ + x] = 0;
        }
        return flags.release();
    }

    /// Whether a macroblock has the samples of the last frame.
    [[nodiscard]] bool is_constant(const AVFrame& frame, int column, int row) const {
        for (int plane = 0; plane < kPlanes; ++plane) {
            const int shift = plane > 0 && csp_ == X264_CSP_I420 ? 1 : 0;
            const int side = kMacroblockPx >> shift;
            const int x = column * side;
            const auto bytes = static_cast<std::size_t>(std::min(side, (frame.width >> shift) - x));
            const int y1 = std::min((row + 1) * side, frame.height >> shift);
            for (int y = row * side; y < y1; ++y) {
                const std::uint8_t* const now = frame.data[plane] + std::ptrdiff_t{y} * frame.linesize[plane];
                const std::uint8_t* const before =
                    last_->data[plane] + std::ptrdiff_t{y} * last_->linesize[plane];
                if (std::memcmp(now + x, before + x, bytes) != 0) return false;
            }
        }
        return true;
    }

    /// Encodes a picture, or delayed ones if it is null.
    void encode(x264_picture_t* picture, const PacketSink& sink) {
        const LogCapture log;
        x264_nal_t* nals = nullptr;
        int count = 0;
        x264_picture_t shown;
        const int bytes = x264_encoder_encode(x264_.get(), &nals, &count, picture, &shown);
        if (bytes < 0) {
            const std::string reason = log.text().empty() ? "" : " (" + log.text() + ")";
            throw_error(ExitCode::kEncoder, "libx264 failed near frame {}{}", frames_, reason);
        }
        if (bytes == 0 || shown.i_pts < primed_) return;
        check_libav(av_new_packet(packet_.get(), static_cast<int>(sei_.size()) + bytes), ExitCode::kTemporary,
                    "cannot make a packet");
        std::uint8_t* const end = std::copy(sei_.begin(), sei_.end(), packet_->data);
        std::memcpy(end, nals[0].p_payload, static_cast<std::size_t>(bytes));  // all, one after the other
        sei_.clear();
        packet_->pts = shown.i_pts - primed_;
        packet_->dts = shown.i_dts - primed_;
        packet_->duration = 1;
        if (shown.b_keyframe != 0) packet_->flags |= AV_PKT_FLAG_KEY;
        sink(*packet_);
    }

    QuietLog quiet_;
    int columns_;  ///< of macroblocks
    int rows_;
    AVPixelFormat pixel_format_;
    Frame last_;  ///< the frame before
    CodecParameters parameters_;
    Packet packet_;
    X264 x264_;
    int csp_ = 0;
    std::string sei_;
    std::int64_t frames_ = 0;
    std::int64_t primed_ = 0;  ///< grey pictures
};

}  // namespace

std::string x264_version() {
    return fmt::format("libx264 {}", X264_BUILD);
}

std::unique_ptr<Encoder> make_x264_encoder(const Format& format, const VideoDef& def) {
    return std::make_unique<X264Encoder>(format, def);
}

}  // namespace corda::media
