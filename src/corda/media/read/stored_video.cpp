#include "corda/media/read/stored_video.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "corda/core/text.hpp"
#include "corda/media/encode/yuv420.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/containers.hpp"
#include "corda/media/read/decoder.hpp"

namespace corda::media {

namespace {

/// Copies the samples of a decoded frame; false for a pixel format that is not read.
bool copy_samples(const AVFrame& frame, StoredPicture& picture) {
    const AVPixFmtDescriptor* const format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    constexpr std::uint64_t kUnread = AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_FLOAT |
                                      AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_BAYER;
    const bool is_known = format != nullptr && (format->flags & kUnread) == 0 &&
                          format->comp[0].depth <= 16 &&
                          (format->nb_components == 1 || format->nb_components >= 3);
    if (!is_known || !is_picture_size(frame.width, frame.height)) return false;
    picture.width_px = frame.width;
    picture.height_px = frame.height;
    picture.format = format->name;
    picture.components = format->nb_components;
    picture.is_rgb = (format->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    picture.is_full_range = frame.color_range == AVCOL_RANGE_JPEG;
    picture.bits = format->comp[0].depth;
    picture.chroma_shift_x = format->log2_chroma_w;
    picture.chroma_shift_y = format->log2_chroma_h;
    const auto pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    picture.samples.assign(pixels * static_cast<std::size_t>(picture.components), 0);
    const std::uint8_t* data[4] = {frame.data[0], frame.data[1], frame.data[2], frame.data[3]};
    for (int c = 0; c < picture.components; ++c) {
        const bool is_chroma = !picture.is_rgb && (c == 1 || c == 2);
        const int width = ceiling_shift(frame.width, is_chroma ? format->log2_chroma_w : 0);
        const int height = ceiling_shift(frame.height, is_chroma ? format->log2_chroma_h : 0);
        std::uint16_t* const samples = picture.samples.data() + static_cast<std::size_t>(c) * pixels;
        for (int y = 0; y < height; ++y)
            av_read_image_line2(samples + std::ptrdiff_t{y} * width, data, frame.linesize, format, 0, y, c,
                                width, 0, sizeof(std::uint16_t));
    }
    return true;
}

}  // namespace

struct StoredVideo::Impl {
    explicit Impl(const std::string& file) : path(file) {
        const std::string kind = file_kind(path);
        if (is_truncated(path, kind) || (kind == "mov" && !read_mp4_boxes(path).whole))
            throw_error(ExitCode::kIo, "'{}' breaks off before its end; copy or render it again", path);
        decoder.emplace(path);
        const AVRational fps = decoder->stream().avg_frame_rate;
        if (fps.den > 0) rate = Rational::reduced(fps.num, fps.den);
    }

    bool decode(StoredPicture& picture) {
        if (!decoder->read()) return false;
        const AVFrame& frame = decoder->frame();
        if (!copy_samples(frame, picture))
            throw_error(ExitCode::kIo,
                        "{}: is {} of {}x{}; only grey, R'G'B' or Y'CbCr of up to 16 bits is read", path,
                        av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format)), frame.width,
                        frame.height);
        const bool has_time = frame.best_effort_timestamp != AV_NOPTS_VALUE;
        picture.time_s =
            has_time ? static_cast<double>(frame.best_effort_timestamp) * av_q2d(decoder->stream().time_base)
                     : 0.0;
        return true;
    }

    QuietLog quiet;
    std::string path;
    Rational rate{0, 1};
    std::optional<Decoder> decoder;
};

void StoredVideo::load_libraries() {
    load_libav();
}

StoredVideo::StoredVideo(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}

StoredVideo::~StoredVideo() = default;

Rational StoredVideo::rate() const {
    return impl_->rate;
}

bool StoredVideo::read(StoredPicture& picture) {
    return impl_->decode(picture);
}

Image StoredPicture::rgba() const {
    Image image(width_px, height_px);
    const auto pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
    const double largest = static_cast<double>((1 << bits) - 1);
    const double step = std::ldexp(1.0, bits - 8);  // of 8-bit levels
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    };
    for (int y = 0; y < height_px; ++y) {
        for (int x = 0; x < width_px; ++x) {
            const auto sample = [&](int c, int shift_x = 0, int shift_y = 0) -> double {
                const std::size_t width = static_cast<std::size_t>(ceiling_shift(width_px, shift_x));
                return samples[static_cast<std::size_t>(c) * pixels +
                               static_cast<std::size_t>(y >> shift_y) * width +
                               static_cast<std::size_t>(x >> shift_x)];
            };
            const auto chroma = [&](int c) {
                return components < 3 ? 128.0 : sample(c, chroma_shift_x, chroma_shift_y) / step;
            };
            const auto level = [&](int c) { return 255.0 * sample(c) / largest; };
            const std::array<double, 3> rgb =
                is_rgb ? std::array{level(0), level(1), level(2)}
                       : rgb_from_ycbcr(is_full_range ? level(0) : sample(0) / step, chroma(1), chroma(2),
                                        is_full_range);
            std::uint8_t* const rgba = image.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) rgba[c] = byte(rgb[c]);
            rgba[3] = components == 4 ? byte(level(3)) : 255;
        }
    }
    return image;
}

}  // namespace corda::media
