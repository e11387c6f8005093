#include "corda/media/verify/check_video.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/encode/yuv420.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

/// The mean R'G'B' of the 16x16 pixels at (x, y) of a picture, in 0 .. 255.
struct Patch {
    int x = 0;
    int y = 0;
    std::array<double, 3> rgb{};
};

constexpr int kPatchPx = 16;
constexpr std::size_t kMaxPatches = 5;

struct Expected {
    const Format& format;
    const VideoDef& def;
    std::int64_t frames;
    const Image& first;
};

template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) {
    throw_error(ExitCode::kEncoder, "the finished video fails its check: {}; try another preset or codec",
                fmt::format(text, std::forward<Args>(args)...));
}

/// Whether colours change slowly in a block and around it.
bool is_flat(const Image& picture, int x, int y) {
    // Deblocking changes 3 pixels, the chroma filter reads 1, and an 8x8 transform block spreads over 8.
    constexpr int kMargin = 8;
    constexpr int kLevels = 4;  // a dithered ground is no edge
    const PixelRect block =
        PixelRect{x - kMargin, y - kMargin, x + kPatchPx + kMargin, y + kPatchPx + kMargin}.intersected(
            picture.rect());
    const auto are_alike = [](const std::uint8_t* a, const std::uint8_t* b) {
        return std::equal(a, a + 3, b, [](int u, int v) { return std::abs(u - v) <= kLevels; });
    };
    for (int row = block.y0; row < block.y1; ++row) {
        for (int column = block.x0; column < block.x1; ++column) {
            const std::uint8_t* const pixel = picture.pixel(column, row);
            if (column > block.x0 && !are_alike(pixel, picture.pixel(column - 1, row))) return false;
            if (row > block.y0 && !are_alike(pixel, picture.pixel(column, row - 1))) return false;
        }
    }
    return true;
}

std::array<double, 3> mean_color(const Image& picture, int x, int y) {
    std::array<double, 3> mean{};
    for (int i = 0; i < kPatchPx * kPatchPx; ++i) {
        const std::uint8_t* const pixel = picture.pixel(x + i % kPatchPx, y + i / kPatchPx);
        for (std::size_t c = 0; c < 3; ++c) mean[c] += pixel[c] / double{kPatchPx * kPatchPx};
    }
    return mean;
}

double largest_difference(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    double largest = 0.0;
    for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
    return largest;
}

/// Up to five blocks of different colours without an edge in them or near them, so that neither deblocking
/// nor the chroma filter mixes in another colour.
std::vector<Patch> patches_of(const Image& picture) {
    const int columns = picture.width() / kPatchPx;
    const int blocks = columns * (picture.height() / kPatchPx);
    constexpr std::int64_t kStride = 7919;  // a prime: all over the picture
    std::vector<Patch> patches;
    for (std::int64_t i = 0; i < blocks && patches.size() < kMaxPatches; ++i) {
        const auto block = static_cast<int>(i * kStride % blocks);
        const int x = block % columns * kPatchPx;
        const int y = block / columns * kPatchPx;
        if (!is_flat(picture, x, y)) continue;
        const Patch patch{x, y, mean_color(picture, x, y)};
        const auto is_alike = [&patch](const Patch& other) {
            return largest_difference(other.rgb, patch.rgb) < 1.0;
        };
        if (std::ranges::none_of(patches, is_alike)) patches.push_back(patch);
    }
    return patches;
}

/// The largest error that a channel of a patch may have in a correct video, in 1/255.
double tolerance_of(const Format& format, const EncoderDef& def) {
    const Codec& codec = *format.codec;
    if (codec.tolerance > 0.0) return codec.tolerance;
    if (!codec.crf) return 2.0;
    constexpr int kMaxCrf = 51;
    int crf = format.crf_of(def) * kMaxCrf / codec.crf->second;
    // H.264 and H.265 quantise the colour of 4:4:4 more coarsely: dark grounds are off by 5.5 at crf 24 and
    // 6.5 at 30, as 4:2:0 is at 9 more.
    if (codec.has_coarse_444 && std::string_view(format.pixel_format) == "yuv444p")
        crf = std::min(crf + 9, kMaxCrf);
    // Measured with random and saturated colours and five presets: at most 1.7 up to crf 25 (of which 1.6 is
    // the rounding to 8-bit Y'CbCr), 3.2 at 28, 3.9 at 33, 6.5 at 40, 11 at 45, 25 at 51. A wrong matrix or
    // range is off by 15 or more.
    return std::max(2.0, 2.0 * std::exp2((crf - 21) / 7.0));
}

const AVPixFmtDescriptor& descriptor_of(const AVFrame& frame) {
    return *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
}

/// Mean of a component within a patch, in 0 .. 255.
double mean_of(const AVFrame& frame, int component, const Patch& patch) {
    const AVPixFmtDescriptor& format = descriptor_of(frame);
    const bool is_chroma = (format.flags & AV_PIX_FMT_FLAG_RGB) == 0 && (component == 1 || component == 2);
    const int right = is_chroma ? format.log2_chroma_w : 0;
    const int down = is_chroma ? format.log2_chroma_h : 0;
    const std::uint8_t* data[4] = {frame.data[0], frame.data[1], frame.data[2], frame.data[3]};
    std::array<std::uint16_t, kPatchPx> line{};
    const int width = kPatchPx >> right;
    const int height = kPatchPx >> down;
    double sum = 0.0;
    for (int y = 0; y < height; ++y) {
        av_read_image_line2(line.data(), data, frame.linesize, &format, patch.x >> right,
                            (patch.y >> down) + y, component, width, 0, sizeof(std::uint16_t));
        for (int x = 0; x < width; ++x) sum += line[static_cast<std::size_t>(x)];
    }
    return sum / (width * height * (1 << (format.comp[component].depth - 8)));
}

void check_colors(const AVFrame& frame, const Expected& expected) {
    const double tolerance = tolerance_of(expected.format, expected.def.encoder);
    const AVPixFmtDescriptor& format = descriptor_of(frame);
    for (const Patch& patch : patches_of(expected.first)) {
        // A GIF has no colour where it is transparent.
        const bool is_gif = expected.format.codec->stream == std::string_view("gif");
        if (is_gif && mean_of(frame, 3, patch) < 255.0) continue;
        const double a = mean_of(frame, 0, patch);
        const double b = mean_of(frame, 1, patch);
        const double c = mean_of(frame, 2, patch);
        std::array<double, 3> rgb{a, b, c};
        if ((format.flags & AV_PIX_FMT_FLAG_RGB) == 0) rgb = rgb_from_ycbcr(a, b, c);
        for (double& level : rgb) level = std::clamp(level, 0.0, 255.0);
        if (largest_difference(rgb, patch.rgb) > tolerance)
            fail(
                "the first picture has R'G'B' {:.1f} {:.1f} {:.1f} at ({}, {}), and {:.1f} {:.1f} {:.1f} was "
                "drawn",
                rgb[0], rgb[1], rgb[2], patch.x, patch.y, patch.rgb[0], patch.rgb[1], patch.rgb[2]);
    }
}

/// Colour tags of a track or of a decoded picture.
struct ColorTags {
    AVColorRange color_range;
    AVColorSpace colorspace;
    AVColorPrimaries color_primaries;
    AVColorTransferCharacteristic color_trc;

    [[nodiscard]] std::string text() const {
        const auto named = [](const char* name) { return name == nullptr ? "none" : name; };
        return fmt::format(
            "{}, {}, {}, {}", named(av_color_range_name(color_range)), named(av_color_space_name(colorspace)),
            named(av_color_primaries_name(color_primaries)), named(av_color_transfer_name(color_trc)));
    }
};

void check_tags(const ColorTags& found, const Expected& expected, std::string_view where) {
    ColorTags wanted{};
    set_colors(av_get_pix_fmt(expected.format.pixel_format), wanted);
    // The colr box of QuickTime has no range.
    const bool has_range = found.color_range != AVCOL_RANGE_UNSPECIFIED ||
                           expected.format.ending->muxer != std::string_view("mov");
    if (!has_range) wanted.color_range = found.color_range;
    if (found.text() != wanted.text())
        fail("the colour tags of the {} are {} instead of {}", where, found.text(), wanted.text());
}

/// Decodes a packet that needs no other one, and checks the picture.
void check_first_picture(const AVPacket& packet, const AVStream& stream, const Expected& expected) {
    const AVCodec* const codec = avcodec_find_decoder(stream.codecpar->codec_id);
    if (codec == nullptr) return;  // of an encoder whose libavcodec has no decoder
    const auto check = [](int status) {
        check_libav(status, ExitCode::kEncoder, "the first picture of the finished video does not decode");
    };
    const CodecContext context = check_allocated(CodecContext(avcodec_alloc_context3(codec)), "a decoder");
    const Frame frame = check_allocated(Frame(av_frame_alloc()), "a frame");
    check(avcodec_parameters_to_context(context.get(), stream.codecpar));
    context->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    check(avcodec_open2(context.get(), codec, nullptr));
    check(avcodec_send_packet(context.get(), &packet));
    check(avcodec_send_packet(context.get(), nullptr));
    check(avcodec_receive_frame(context.get(), frame.get()));
    if (frame->width != expected.def.width_px || frame->height != expected.def.height_px)
        fail("the first picture has {}x{} pixels", frame->width, frame->height);
    check_colors(*frame, expected);
    if ((descriptor_of(*frame).flags & AV_PIX_FMT_FLAG_RGB) != 0) return;  // sRGB by definition
    check_tags({frame->color_range, frame->colorspace, frame->color_primaries, frame->color_trc}, expected,
               "first picture");
}

/// Whether the index of an MP4 or QuickTime file follows its first box, so that browsers start to play at
/// once.
bool has_index_first(const std::string& path) {
    const std::string head = first_bytes(path, 4096);
    std::size_t index = 0;  // where the second box begins: the size of the first, the largest byte first
    for (const char byte : head.substr(0, 4)) index = index << 8U | static_cast<unsigned char>(byte);
    return head.size() >= index + 8 && head.substr(index + 4, 4) == "moov";
}

/// Checks the length of a track whose last frame ends at tick `end`.
void check_duration(const AVStream& stream, std::int64_t end, const Expected& expected) {
    const AVRational frame = frame_time_base(expected.def.fps.rational());
    const std::string_view muxer = expected.format.ending->muxer;
    const bool is_exact = muxer == "mp4" || muxer == "mov";  // they state it in ticks
    const std::int64_t nearest = av_rescale_q(expected.frames, frame, stream.time_base);
    // Others round the duration of the last frame.
    const bool is_right = is_exact
                              ? av_compare_ts(stream.duration, stream.time_base, expected.frames, frame) == 0
                              : std::abs(nearest - end) <= 1;
    if (is_exact && av_compare_ts(1, frame, av_rescale_q(1, frame, stream.time_base), stream.time_base) != 0)
        fail("its clock of 1/{} s does not count frames", stream.time_base.den);
    if (!is_right) fail("it does not last {} frames", expected.frames);
}

}  // namespace

void check_video(const std::string& path, const Format& format, const VideoDef& def, std::int64_t frames,
                 const Image& first) {
    const Expected expected{format, def, frames, first};
    const LogCapture log;
    const std::string kind = file_kind(path);
    AVFormatContext* opened = nullptr;
    check_libav(
        avformat_open_input(&opened, file_url(path).c_str(), av_find_input_format(kind.c_str()), nullptr),
        ExitCode::kEncoder, "the finished video does not open");
    const InputFormat file(opened);
    if (file->nb_streams != 1) fail("it has {} tracks", file->nb_streams);
    const AVStream& stream = *file->streams[0];
    const AVRational frame = frame_time_base(def.fps.rational());
    const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
    std::int64_t count = 0;
    std::int64_t end = 0;
    while (av_read_frame(file.get(), packet.get()) >= 0) {
        check_cancelled();
        if (packet->pts != av_rescale_q(count, frame, stream.time_base))
            fail("frame {} is at tick {} of 1/{} s", count, packet->pts, stream.time_base.den);
        if (count == 0) check_first_picture(*packet, stream, expected);
        ++count;
        end = packet->pts + packet->duration;
        av_packet_unref(packet.get());
    }
    if (count != frames) fail("it has {} frames instead of {}", count, frames);
    check_duration(stream, end, expected);
    if (kind != "gif")
        check_tags({stream.codecpar->color_range, stream.codecpar->color_space,
                    stream.codecpar->color_primaries, stream.codecpar->color_trc},
                   expected, "container");
    if (kind == "mov" && !has_index_first(path)) fail("its index is not before its pictures");
}

}  // namespace corda::media
