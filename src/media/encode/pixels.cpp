#include "corda/media/encode/pixels.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>

#include "corda/media/encode/yuv420.hpp"

namespace corda::media {
namespace {

void copy_alpha(const Image& image, const PixelRect& part, int bits, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        std::uint8_t* const line = frame.data[3] + std::ptrdiff_t{y} * frame.linesize[3];
        for (int x = part.x0; x < part.x1; ++x) {
            const int alpha = image.pixel(x, y)[3];
            if (bits == 8) {
                line[x] = static_cast<std::uint8_t>(alpha);
                continue;
            }
            const int value = (alpha * 1023 + 127) / 255;
            line[std::ptrdiff_t{2} * x] = static_cast<std::uint8_t>(value);
            line[std::ptrdiff_t{2} * x + 1] = static_cast<std::uint8_t>(value >> 8);
        }
    }
}

void copy_bgr(const Image& image, const PixelRect& part, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        std::uint8_t* const line = frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0];
        for (int x = part.x0; x < part.x1; ++x) {
            const std::uint8_t* const from = image.pixel(x, y);
            std::uint8_t* const to = line + std::ptrdiff_t{4} * x;
            to[0] = from[2];
            to[1] = from[1];
            to[2] = from[0];
            to[3] = from[3];
        }
    }
}

void copy_rgb(const Image& image, const PixelRect& part, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        std::uint8_t* const line = frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0];
        std::memcpy(line + std::ptrdiff_t{4} * part.x0, image.pixel(part.x0, y),
                    static_cast<std::size_t>(part.width()) * 4);
    }
}

void copy_argb(const Image& image, const PixelRect& part, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        std::uint8_t* const line = frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0];
        for (int x = part.x0; x < part.x1; ++x) {
            const std::uint8_t* const from = image.pixel(x, y);
            std::uint8_t* const to = line + std::ptrdiff_t{4} * x;
            to[0] = from[3];
            std::copy_n(from, 3, to + 1);
        }
    }
}

void copy_without_alpha(const Image& image, const PixelRect& part, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        std::uint8_t* const line = frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0];
        for (int x = part.x0; x < part.x1; ++x)
            std::copy_n(image.pixel(x, y), 3, line + std::ptrdiff_t{3} * x);
    }
}

}  // namespace

void convert_pixels(const Image& image, const PixelRect& part, AVFrame& frame) {
    assert(image.width() == frame.width && image.height() == frame.height);
    const PixelRect inside = part.intersected(image.rect());
    if (inside.empty()) return;
    const YuvPlanes planes{{frame.data[0], frame.data[1], frame.data[2]},
                           {frame.linesize[0], frame.linesize[1], frame.linesize[2]}};
    switch (frame.format) {
        case AV_PIX_FMT_YUVA420P:
            copy_alpha(image, inside, 8, frame);
            [[fallthrough]];
        case AV_PIX_FMT_YUV420P:
            return convert_to_yuv420(image, inside, planes);
        case AV_PIX_FMT_YUV444P:
            return convert_to_yuv444(image, inside, 8, planes);
        case AV_PIX_FMT_YUVA444P10LE:
            copy_alpha(image, inside, 10, frame);
            [[fallthrough]];
        case AV_PIX_FMT_YUV444P10LE:
            return convert_to_yuv444(image, inside, 10, planes);
        case AV_PIX_FMT_BGR0:
        case AV_PIX_FMT_BGRA:
            return copy_bgr(image, inside, frame);
        case AV_PIX_FMT_ARGB:
            return copy_argb(image, inside, frame);
        case AV_PIX_FMT_RGBA:
            return copy_rgb(image, inside, frame);
        case AV_PIX_FMT_RGB24:
            return copy_without_alpha(image, inside, frame);
        default:
            throw Error(ExitCode::kInternal, "frames are not converted to this pixel format");
    }
}

bool copy_exact(const AVFrame& frame, Image& picture) {
    if (picture.width() != frame.width || picture.height() != frame.height)
        picture = Image(frame.width, frame.height);
    const auto copy = [&](std::ptrdiff_t bytes, int red, int green, int blue, int alpha) {
        for (int y = 0; y < frame.height; ++y) {
            const std::uint8_t* from = frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0];
            std::uint8_t* to = picture.pixel(0, y);
            for (int x = 0; x < frame.width; ++x, from += bytes, to += 4) {
                to[0] = from[red];
                to[1] = from[green];
                to[2] = from[blue];
                to[3] = alpha < 0 ? 255 : from[alpha];
            }
        }
        return true;
    };
    switch (frame.format) {
        case AV_PIX_FMT_BGR0:
            return copy(4, 2, 1, 0, -1);
        case AV_PIX_FMT_BGRA:
            return copy(4, 2, 1, 0, 3);
        case AV_PIX_FMT_ARGB:
            return copy(4, 1, 2, 3, 0);
        case AV_PIX_FMT_RGB24:
            return copy(3, 0, 1, 2, -1);
        default:
            return false;
    }
}

void ShownPictures::convert(const AVFrame& frame, Image& picture) {
    const auto format = static_cast<AVPixelFormat>(frame.format);
    // Chroma is interpolated, not repeated, and nothing is rounded to the speed of a CPU's instructions.
    constexpr int kFlags =
        SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_ACCURATE_RND | SWS_BITEXACT;
    scaler_.reset(sws_getCachedContext(scaler_.release(), frame.width, frame.height, format, frame.width,
                                       frame.height, AV_PIX_FMT_RGBA, kFlags, nullptr, nullptr, nullptr));
    if (!scaler_)
        throw Error(ExitCode::kIo, fmt::format("pictures of the pixel format {} cannot be converted",
                                               av_get_pix_fmt_name(format)));
    const int matrix =
        frame.colorspace == AVCOL_SPC_UNSPECIFIED ? SWS_CS_ITU709 : static_cast<int>(frame.colorspace);
    const int* const table = sws_getCoefficients(matrix);
    const int is_full_range = frame.color_range == AVCOL_RANGE_JPEG ? 1 : 0;
    constexpr int kOne = 1 << 16;
    sws_setColorspaceDetails(scaler_.get(), table, is_full_range, table, 1, 0, kOne, kOne);
    if (picture.width() != frame.width || picture.height() != frame.height)
        picture = Image(frame.width, frame.height);
    std::uint8_t* const rows = picture.data();
    const auto row_bytes = static_cast<int>(picture.row_bytes());
    sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, &rows, &row_bytes);
}

void AlphaBleed::search_row(const Image& image, int y, const PixelRect& grown, Found* row) const {
    const auto shows = [&](int x) { return image.pixel(x, y)[3] >= kMinAlpha; };
    constexpr int kNone = kReachPx + 1;
    int last = grown.x0 - kReachPx;  // the nearest pixel that shows, to the left
    bool has_last = false;
    for (int x = std::max(0, grown.x0 - kReachPx); x < grown.x0; ++x)
        if (shows(x)) {
            last = x;
            has_last = true;
        }
    for (int x = grown.x0; x < grown.x1; ++x) {
        if (shows(x)) {
            last = x;
            has_last = true;
        }
        const int distance = has_last ? std::min(x - last, kNone) : kNone;
        const std::uint8_t* const p = image.pixel(distance < kNone ? last : x, y);
        *row++ = {p[0], p[1], p[2], static_cast<std::uint8_t>(distance)};
    }
    // What is nearer to the right.
    int next = 0;
    bool has_next = false;
    for (int x = std::min(image.width(), grown.x1 + kReachPx) - 1; x >= grown.x0; --x) {
        if (x < grown.x1) --row;
        if (shows(x)) {
            next = x;
            has_next = true;
        }
        if (x >= grown.x1 || !has_next || next - x >= row->distance) continue;
        const std::uint8_t* const p = image.pixel(next, y);
        *row = {p[0], p[1], p[2], static_cast<std::uint8_t>(next - x)};
    }
}

PixelRect AlphaBleed::update(const Image& image, const PixelRect& part) {
    const bool is_new = picture_.width() != image.width() || picture_.height() != image.height();
    if (is_new) picture_ = Image(image.width(), image.height());
    const PixelRect changed = is_new ? image.rect() : part;
    const PixelRect grown =
        PixelRect{changed.x0 - kReachPx, changed.y0 - kReachPx, changed.x1 + kReachPx, changed.y1 + kReachPx}
            .intersected(image.rect());
    if (grown.empty()) return grown;
    const auto width = static_cast<std::size_t>(grown.width());
    const int first = std::max(0, grown.y0 - kReachPx);
    const int end = std::min(image.height(), grown.y1 + kReachPx);
    rows_.resize(width * static_cast<std::size_t>(end - first));
    for (int y = first; y < end; ++y)
        search_row(image, y, grown, &rows_[width * static_cast<std::size_t>(y - first)]);
    for (int y = grown.y0; y < grown.y1; ++y) {
        for (int x = grown.x0; x < grown.x1; ++x) {
            const std::uint8_t* const from = image.pixel(x, y);
            std::uint8_t* const to = picture_.pixel(x, y);
            std::copy_n(from, 4, to);
            if (from[3] >= kMinAlpha) continue;
            const Found* nearest = nullptr;
            int least = kReachPx * kReachPx + 1;  // squared
            for (int d = 0; d <= kReachPx && d * d < least; ++d) {
                for (const int row : {y - d, y + d}) {
                    if (row < first || row >= end) continue;
                    const Found& found = rows_[width * static_cast<std::size_t>(row - first) +
                                               static_cast<std::size_t>(x - grown.x0)];
                    const int square = d * d + found.distance * found.distance;
                    if (found.distance > kReachPx || square >= least) continue;
                    least = square;
                    nearest = &found;
                }
            }
            if (nearest == nullptr) continue;
            to[0] = nearest->r;
            to[1] = nearest->g;
            to[2] = nearest->b;
        }
    }
    return grown;
}

}  // namespace corda::media
