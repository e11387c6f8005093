#include "corda/media/encode/pixels.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>

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

/// Where the channels of a packed pixel of 8-bit R'G'B' are.
struct PackedPixel {
    int bytes = 0;
    std::array<int, 4> offset{};  ///< of R, G, B and of alpha, or of the byte in its place
    bool has_alpha = false;
};

/// The packed pixel of a format; std::nullopt if it has none.
std::optional<PackedPixel> packed_pixel(const AVPixFmtDescriptor& descriptor) {
    constexpr std::uint64_t kKind = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PLANAR | AV_PIX_FMT_FLAG_PAL;
    const auto& comp = descriptor.comp;
    const bool is_packed =
        (descriptor.flags & kKind) == AV_PIX_FMT_FLAG_RGB && comp[0].depth == 8 && comp[0].step >= 3;
    if (!is_packed) return std::nullopt;
    const int last = 6 - comp[0].offset - comp[1].offset - comp[2].offset;  // offsets are 0 .. 3
    return PackedPixel{comp[0].step,
                       {comp[0].offset, comp[1].offset, comp[2].offset, last},
                       (descriptor.flags & AV_PIX_FMT_FLAG_ALPHA) != 0};
}

void copy_packed(const Image& image, const PixelRect& part, const PackedPixel& pixel, AVFrame& frame) {
    for (int y = part.y0; y < part.y1; ++y) {
        const std::uint8_t* from = image.pixel(part.x0, y);
        std::uint8_t* to =
            frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0] + std::ptrdiff_t{pixel.bytes} * part.x0;
        for (int x = part.x0; x < part.x1; ++x, from += 4, to += pixel.bytes)
            for (int c = 0; c < pixel.bytes; ++c) to[pixel.offset[c]] = from[c];
    }
}

}  // namespace

void convert_pixels(const Image& image, const PixelRect& part, AVFrame& frame) {
    assert(image.width() == frame.width && image.height() == frame.height);
    const PixelRect inside = part.intersected(image.rect());
    if (inside.empty()) return;
    const AVPixFmtDescriptor& descriptor = *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    if (const auto pixel = packed_pixel(descriptor)) return copy_packed(image, inside, *pixel, frame);
    const int bits = descriptor.comp[0].depth;
    const bool is_420 = descriptor.log2_chroma_w == 1 && descriptor.log2_chroma_h == 1;
    const bool is_444 = descriptor.log2_chroma_w == 0 && descriptor.log2_chroma_h == 0;
    const bool is_known =
        (descriptor.flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BE)) == 0 &&
        descriptor.nb_components >= 3 && descriptor.comp[2].plane == 2 &&
        ((is_420 && bits == 8) || (is_444 && (bits == 8 || bits == 10)));
    if (!is_known) throw Error(ExitCode::kInternal, "frames are not converted to this pixel format");
    if ((descriptor.flags & AV_PIX_FMT_FLAG_ALPHA) != 0) copy_alpha(image, inside, bits, frame);
    const YuvPlanes planes{{frame.data[0], frame.data[1], frame.data[2]},
                           {frame.linesize[0], frame.linesize[1], frame.linesize[2]}};
    if (is_420) return convert_to_yuv420(image, inside, planes);
    convert_to_yuv444(image, inside, bits, planes);
}

Frame new_frame(AVPixelFormat format, int width, int height, BufferPool& pool) {
    Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    frame->format = format;
    frame->width = width;
    frame->height = height;
    frame->sample_aspect_ratio = {1, 1};
    set_duration(*frame, 1);
    set_colors(format, *frame);
    frame->chroma_location = chroma_location(format);
    constexpr int kAlignment = 64;
    const int rows = FFALIGN(height, 32);  // encoders may read beyond lines and rows
    const int bytes = av_image_get_buffer_size(format, width, rows, kAlignment);
    check_libav(bytes, ExitCode::kTemporary, "cannot make a picture");
    const auto room = static_cast<std::size_t>(bytes) + kAlignment;
    if (!pool) pool = check_allocated(BufferPool(av_buffer_pool_init(room, nullptr)), "a picture");
    frame->buf[0] = av_buffer_pool_get(pool.get());
    if (frame->buf[0] == nullptr) check_libav(AVERROR(ENOMEM), ExitCode::kTemporary, "cannot make a picture");
    check_libav(av_image_fill_arrays(frame->data, frame->linesize, frame->buf[0]->data, format, width, rows,
                                     kAlignment),
                ExitCode::kTemporary, "cannot make a picture");
    return frame;
}

Frame new_frame(AVPixelFormat format, int width, int height) {
    BufferPool pool;  // its memory stays with the frame
    return new_frame(format, width, height, pool);
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
