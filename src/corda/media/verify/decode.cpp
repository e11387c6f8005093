#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/encode/yuv420.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/color_patch.hpp"
#include "corda/media/read/containers.hpp"
#include "corda/media/read/decoder.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/media/verify/checks.hpp"

namespace corda::media {
namespace {

std::string named(const char* name) {
    return name == nullptr ? "unknown" : name;
}

/// The samples of one component in a square of a frame, of any pixel format, as a mean in 0 .. 255 (of more
/// bits, in quarters and so on), and their minimum.
struct Samples {
    double mean = 0.0;
    int least = 255;
};

Samples samples_of(const AVFrame& frame, int component, const PixelRect& part) {
    const AVPixFmtDescriptor& descriptor = *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    const bool is_chroma =
        (descriptor.flags & AV_PIX_FMT_FLAG_RGB) == 0 && (component == 1 || component == 2);
    const int right = is_chroma ? descriptor.log2_chroma_w : 0;
    const int down = is_chroma ? descriptor.log2_chroma_h : 0;
    const int depth = descriptor.comp[component].depth;
    const std::uint8_t* data[4] = {frame.data[0], frame.data[1], frame.data[2], frame.data[3]};
    std::vector<std::uint16_t> line(static_cast<std::size_t>(part.width() >> right));
    std::int64_t sum = 0;
    std::int64_t count = 0;
    int least = (1 << depth) - 1;
    for (int y = part.y0 >> down; y < part.y1 >> down; ++y) {
        av_read_image_line2(line.data(), data, frame.linesize, &descriptor, part.x0 >> right, y, component,
                            static_cast<int>(line.size()), 0, 2);
        for (const std::uint16_t value : line) {
            sum += value;
            least = std::min(least, int{value});
        }
        count += std::ssize(line);
    }
    const double scale = static_cast<double>(1 << (depth - 8));
    return {static_cast<double>(sum) / (scale * static_cast<double>(std::max<std::int64_t>(1, count))),
            least >> (depth - 8)};
}

/// Mean R'G'B' of a square.
std::array<double, 3> mean_rgb_of(const AVFrame& frame, const PixelRect& part) {
    const AVPixFmtDescriptor& descriptor = *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    std::array<double, 3> means{};
    for (int c = 0; c < 3; ++c) means[static_cast<std::size_t>(c)] = samples_of(frame, c, part).mean;
    return (descriptor.flags & AV_PIX_FMT_FLAG_RGB) != 0 ? means
                                                         : rgb_from_ycbcr(means[0], means[1], means[2]);
}

constexpr std::int64_t kGifTicks = 100;  // per second

bool fits(Rational fps, const std::vector<std::int64_t>& ends, std::int64_t ticks_per_second) {
    std::int64_t k = 0;
    return std::ranges::all_of(ends, [&](std::int64_t end) {
        ++k;
        return (2 * ticks_per_second * k * fps.den + fps.num) / (2 * fps.num) == end;
    });
}

/// The fraction of smallest denominator that fits.
std::optional<Rational> simplest_rate(const std::vector<std::int64_t>& ends, std::int64_t ticks_per_second) {
    constexpr std::int64_t kMaxDenominator = 10'000;
    double low = 0.0;  // that fitting rates are above, and those up to which they are
    double high = 2.0 * static_cast<double>(ticks_per_second);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const double frames = 2.0 * static_cast<double>(ticks_per_second) * static_cast<double>(i + 1);
        const double twice_end = 2.0 * static_cast<double>(ends[i]);
        low = std::max(low, frames / (twice_end + 1.0));
        if (twice_end > 0.0) high = std::min(high, frames / (twice_end - 1.0));
    }
    for (std::int64_t den = 1; den <= kMaxDenominator; ++den) {
        const auto num = static_cast<std::int64_t>(std::floor(high * static_cast<double>(den)));
        if (num > 0 && static_cast<double>(num) > low * static_cast<double>(den) &&
            fits({num, den}, ends, ticks_per_second))
            return Rational{num, den};
    }
    return std::nullopt;
}

/// The rate whose frames, rounded to ticks, end at these times: `stated`, a usual one, or the simplest.
std::optional<Rational> rate_of_ends(const std::vector<std::int64_t>& ends, std::optional<Rational> stated,
                                     std::int64_t ticks_per_second) {
    if (ends.empty() || ends.back() <= 0) return std::nullopt;
    if (stated && fits(*stated, ends, ticks_per_second)) return stated;
    for (const Rational usual :
         {Rational{60, 1}, Rational{30, 1}, Rational{25, 1}, Rational{24, 1}, Rational{50, 1},
          Rational{30000, 1001}, Rational{24000, 1001}, Rational{60000, 1001}})
        if (fits(usual, ends, ticks_per_second)) return usual;
    const Rational mean = Rational::reduced(ticks_per_second * std::ssize(ends), ends.back());
    return mean.den == 1 && fits(mean, ends, ticks_per_second) ? mean : simplest_rate(ends, ticks_per_second);
}

/// Decodes one file and fills in a DecodedVideo.
class Decoding {
  public:
    Decoding(DecodedVideo& video, VerifyReport& report, VerifyDepth depth, std::optional<Rational> stated,
             const std::vector<FrameColors>& rendered)
        : video_(video), report_(report), depth_(depth), stated_(stated), rendered_(rendered) {}

    void run(const std::string& path) {
        if (!open(path)) return;
        video_.opened = true;
        const auto use = [&](const AVPacket& packet) {
            check_cancelled();
            return use_of(packet);
        };
        for (int status = 0; status != AVERROR_EOF;) {
            status = decoder_->next(log_, use);
            if (status == 0)
                take_frame(decoder_->frame());
            else if (status != AVERROR_EOF)
                note_bad(status);
        }
        take_stamps(0);
        if (is_gif_ && report_.frames > 0) find_gif_rate();
        // libav guesses the duration of the last frame; check_clocks in checks.cpp compares the end with the
        // track's stored duration.
        const std::int64_t duration = decoder_->stream().duration;
        if (report_.frames == 1 && (rounded_to_ || counts_frames_))
            video_.step = 1;
        else if (report_.frames == 1)
            video_.step = is_sane_stamp(duration) ? std::max<std::int64_t>(duration, 0) : 0;
        video_.end = last_pts_ + video_.step;
        describe();
    }

  private:
    bool open(const std::string& path) {
        try {
            decoder_.emplace(path);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo) throw;
            video_.open_reason = error.what();
            return false;
        }
        const AVStream& stream = decoder_->stream();
        const AVCodecParameters& parameters = *stream.codecpar;
        video_.container_tags = named(av_color_range_name(parameters.color_range)) + " " +
                                named(av_color_space_name(parameters.color_space)) + " " +
                                named(av_color_primaries_name(parameters.color_primaries)) + " " +
                                named(av_color_transfer_name(parameters.color_trc));
        video_.comment = metadata_entry(decoder_->format(), "comment");
        video_.tick = {stream.time_base.num, stream.time_base.den};
        find_rounded_rate();
        is_gif_ = is_kind("gif");
        counts_frames_ = counts_frames_ || is_gif_;
        return true;
    }

    [[nodiscard]] bool is_kind(const char* demuxer) const {
        return decoder_->format().iformat == av_find_input_format(demuxer);
    }

    /// Matroska counts milliseconds: then the rate that the file states gives the nearest stamp.
    void find_rounded_rate() {
        if (!is_kind("matroska")) return;
        const auto stated = comment_rate(video_.comment);
        const AVRational average = decoder_->stream().avg_frame_rate;
        const Rational rate = stated ? *stated : Rational{average.num, average.den};
        if (rate.num <= 0 || rate.den <= 0) return;
        rounded_to_ = rate;
        video_.is_rounded = true;
        video_.tick = {rate.den, rate.num};
    }

    /// A GIF counts hundredths, and its delays are rounded unless all are equal.
    void find_gif_rate() {
        const std::int64_t start = ends_.front();
        video_.first_pts = start;
        ends_.push_back(ends_.back() + last_duration_);
        ends_.erase(ends_.begin());
        for (std::int64_t& end : ends_) end -= start;
        const std::int64_t delay = ends_.front();
        std::int64_t k = 0;
        const bool is_even = std::ranges::all_of(ends_, [&](std::int64_t end) { return end == ++k * delay; });
        auto fps = rate_of_ends(ends_, stated_, kGifTicks);
        if (is_even && fps != stated_ && delay > 0) fps = Rational::reduced(kGifTicks, delay);
        video_.is_rounded = !is_even;
        if (fps)
            video_.tick = {fps->den, fps->num};
        else
            video_.uneven_at = 1;
    }

    /// The number of the frame that a rounded stamp is the nearest to, or one that fits nowhere.
    [[nodiscard]] std::int64_t unrounded(std::int64_t pts) const {
        const AVRational frame = frame_time_base(*rounded_to_);
        const std::int64_t k = av_rescale_q(pts, decoder_->stream().time_base, frame);
        return av_rescale_q(k, frame, decoder_->stream().time_base) == pts ? k : last_pts_ + kNever;
    }

    void note_bad(int status) {
        if (status == AVERROR(ENOMEM) || decoder_->lacks_memory())
            fail_libav(ExitCode::kTemporary, "decoding", AVERROR(ENOMEM));
        note_bad(log_.text().empty() ? libav_text(status) : log_.text());
    }

    void note_bad(const std::string& reason) {
        if (video_.bad_frames++ == 0) video_.bad_reason = reason;
    }

    /// Decodes all packets, or each key frame alone; then the stamps of packets count. Of frames whose
    /// rendered colours are known in part, the key frames without known colours are skipped.
    Decoder::PacketUse use_of(const AVPacket& packet) {
        last_duration_ = packet.duration;
        if ((packet.flags & AV_PKT_FLAG_CORRUPT) != 0) note_bad(AVERROR_INVALIDDATA);
        if (depth_ == VerifyDepth::kAllFrames) return Decoder::PacketUse::kDecode;
        const bool is_wanted = rendered_.empty() || packets_ < rendered_.front().frame ||
                               find_rendered(rendered_, packets_) != nullptr;
        stamps_.push(packet.pts);
        ++packets_;
        take_stamps(kMaxReordered);
        const bool is_key = (packet.flags & AV_PKT_FLAG_KEY) != 0;
        return is_wanted && is_key ? Decoder::PacketUse::kDecodeAlone : Decoder::PacketUse::kSkip;
    }

    /// Takes the stamps of packets in the order in which their frames are shown, except the last `kept`.
    void take_stamps(std::size_t kept) {
        for (; stamps_.size() > kept; stamps_.pop()) take_stamp(stamps_.top());
    }

    void take_frame(const AVFrame& frame) {
        AVCodecContext& context = decoder_->context();
        // A wrong checksum of FFV1 is only logged, and the slice concealed.
        if (context.codec_id == AV_CODEC_ID_FFV1 && !log_.text().empty()) note_bad(log_.text());
        if (frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0)
            note_bad(AVERROR_INVALIDDATA);
        if (!is_described_) describe_first_frame(frame);
        // Chunks are closed: as many frames are shown before a key frame as packets came before it.
        if (is_readable_)
            measure_patches(frame, depth_ == VerifyDepth::kAllFrames ? report_.frames : packets_ - 1);
        // If no further pixels are measured, it is enough that frames decode.
        if (rendered_.empty()) context.skip_loop_filter = AVDISCARD_ALL;
        if (depth_ == VerifyDepth::kAllFrames) take_stamp(frame.pts);
    }

    void take_stamp(std::int64_t pts) {
        if (!is_sane_stamp(pts)) {
            note_bad(pts == AV_NOPTS_VALUE ? "a frame has no time stamp"
                                           : "a frame has the time stamp " + std::to_string(pts));
            return;
        }
        if (rounded_to_) pts = unrounded(pts);
        if (is_gif_) ends_.push_back(pts);
        if (counts_frames_) pts = report_.frames;
        if (report_.frames == 0) {
            video_.first_pts = pts;
        } else {
            if (report_.frames == 1) video_.step = pts - last_pts_;
            if (pts - last_pts_ != video_.step && video_.uneven_at < 0) video_.uneven_at = report_.frames;
        }
        last_pts_ = pts;
        ++report_.frames;
    }

    void measure_patches(const AVFrame& frame, std::int64_t number) {
        const bool is_gif = decoder_->context().codec_id == AV_CODEC_ID_GIF;
        for (const ColorPatch& patch : patches_of(number)) {
            const PixelRect square{patch.x, patch.y, patch.x + kPatchSide, patch.y + kPatchSide};
            const bool is_inside = is_within(patch, frame.width, frame.height);
            // A GIF has no colour where it is transparent.
            if (is_gif && is_inside && samples_of(frame, 3, square).least < 255) continue;
            ShownPatch& shown = video_.patches.emplace_back(ShownPatch{number, patch, std::nullopt});
            if (is_inside) shown.rgb = mean_rgb_of(frame, square);
        }
    }

    [[nodiscard]] std::vector<ColorPatch> patches_of(std::int64_t number) const {
        if (const FrameColors* const known = find_rendered(rendered_, number)) return known->patches;
        return number == 0 ? comment_patches(video_.comment) : std::vector<ColorPatch>();
    }

    void describe_first_frame(const AVFrame& frame) {
        is_described_ = true;
        report_.width_px = frame.width;
        report_.height_px = frame.height;
        report_.pixel_format = named(av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format)));
        report_.range = named(av_color_range_name(frame.color_range));
        report_.matrix = named(av_color_space_name(frame.colorspace));
        report_.primaries = named(av_color_primaries_name(frame.color_primaries));
        report_.transfer = named(av_color_transfer_name(frame.color_trc));
        report_.chroma_location = named(av_chroma_location_name(frame.chroma_location));
        const AVPixFmtDescriptor* const descriptor =
            av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
        is_readable_ = descriptor != nullptr && descriptor->nb_components >= 3 &&
                       (descriptor->flags &
                        (AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_HWACCEL)) == 0 &&
                       descriptor->comp[0].depth >= 8;
        if (!is_readable_) return;
        video_.is_yuv = (descriptor->flags & AV_PIX_FMT_FLAG_RGB) == 0;
        if ((descriptor->flags & AV_PIX_FMT_FLAG_ALPHA) != 0)
            report_.alpha = samples_of(frame, 3, {0, 0, frame.width, frame.height}).least < 255;
    }

    void describe() {
        const AVCodecContext& context = decoder_->context();
        report_.codec = avcodec_get_name(context.codec_id);
        std::array<char, AV_FOURCC_MAX_STRING_SIZE> tag{};
        video_.codec_tag = av_fourcc_make_string(tag.data(), decoder_->stream().codecpar->codec_tag);
        const char* const profile = avcodec_profile_name(context.codec_id, context.profile);
        report_.profile = profile == nullptr ? "" : profile;
        if (context.codec_id == AV_CODEC_ID_H264) report_.h264_level = std::max(0, context.level);
    }

    static constexpr std::int64_t kNever = 1'000'000'000;
    /// No codec decodes more frames than that ahead of one that is shown before them.
    static constexpr std::size_t kMaxReordered = 32;

    DecodedVideo& video_;
    VerifyReport& report_;
    VerifyDepth depth_;
    std::optional<Rational> stated_;  ///< the rate that the file was rendered for
    const std::vector<FrameColors>& rendered_;
    LogCapture log_;
    std::optional<Decoder> decoder_;
    std::int64_t last_pts_ = 0;
    std::optional<Rational> rounded_to_;
    bool counts_frames_ = false;
    bool is_described_ = false;
    bool is_readable_ = false;  ///< its colours can be measured
    std::int64_t packets_ = 0;  ///< so far, of kKeyFrames
    bool is_gif_ = false;
    std::vector<std::int64_t> ends_;  ///< of a GIF: the times of its frames
    std::int64_t last_duration_ = 0;
    /// Of packets, the least on top.
    std::priority_queue<std::int64_t, std::vector<std::int64_t>, std::greater<>> stamps_;
};

}  // namespace

const FrameColors* find_rendered(const std::vector<FrameColors>& rendered, std::int64_t frame) {
    const auto known = std::lower_bound(
        rendered.begin(), rendered.end(), frame,
        [](const FrameColors& colors, std::int64_t number) { return colors.frame < number; });
    return known != rendered.end() && known->frame == frame ? &*known : nullptr;
}

DecodedVideo decode(const std::string& path, VerifyDepth depth, std::optional<Rational> stated,
                    const std::vector<FrameColors>& rendered, VerifyReport& report) {
    DecodedVideo video;
    Decoding(video, report, depth, stated, rendered).run(path);
    return video;
}

}  // namespace corda::media
