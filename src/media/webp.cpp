#include <fmt/format.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <cstring>
#include <memory>
#include <utility>

#include "corda/core/file.hpp"
#include "corda/media/animation.hpp"
#include "corda/media/video_reader.hpp"

namespace corda::media {
namespace {

using Mux = std::unique_ptr<WebPMux, decltype(&WebPMuxDelete)>;

[[noreturn]] void fail_webp(const std::string& what) {
    throw Error(ExitCode::kEncoder, fmt::format("libwebp {}; use a smaller picture or .apng", what));
}

/// The smallest rectangle in which two pictures differ, from even columns and rows on, as WebP wants it; one
/// pixel if they are equal.
PixelRect difference(const Image& a, const Image& b) {
    PixelRect changed;
    for (int y = 0; y < a.height(); ++y) {
        if (std::memcmp(a.pixel(0, y), b.pixel(0, y), a.row_bytes()) == 0) continue;
        int x0 = 0;
        int x1 = a.width();
        while (std::memcmp(a.pixel(x0, y), b.pixel(x0, y), 4) == 0) ++x0;
        while (std::memcmp(a.pixel(x1 - 1, y), b.pixel(x1 - 1, y), 4) == 0) --x1;
        changed = changed.united({x0, y, x1, y + 1});
    }
    if (changed.empty()) return {0, 0, 1, 1};
    return {changed.x0 / 2 * 2, changed.y0 / 2 * 2, changed.x1, changed.y1};
}

/// What libwebp frees by itself.
struct Encoded {
    Encoded() { WebPMemoryWriterInit(&writer); }
    Encoded(const Encoded&) = delete;
    Encoded& operator=(const Encoded&) = delete;
    ~Encoded() { WebPMemoryWriterClear(&writer); }
    WebPMemoryWriter writer{};
};

/// A part of a picture as a lossless WebP.
void encode(const Image& image, const PixelRect& part, Encoded& bytes) {
    WebPConfig config;
    WebPPicture picture;
    constexpr int kEffort = 1;  // of 9: 6, libwebp's own, takes twice the time for 10 to 14 % fewer bytes
    if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0 ||
        WebPConfigLosslessPreset(&config, kEffort) == 0)
        fail_webp("has another version");
    config.exact = 1;
    picture.use_argb = 1;
    picture.width = part.width();
    picture.height = part.height();
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &bytes.writer;
    const bool is_done = WebPPictureImportRGBA(&picture, image.pixel(part.x0, part.y0),
                                               static_cast<int>(image.row_bytes())) != 0 &&
                         WebPEncode(&config, &picture) != 0;
    const int code = picture.error_code;
    WebPPictureFree(&picture);
    if (!is_done) fail_webp(fmt::format("does not encode a frame (its error {})", code));
}

}  // namespace

void write_webp(const std::string& part_path, Rational fps, std::int64_t frames,
                const OnProgress& on_progress, OutputFile& output) {
    const Mux mux(WebPMuxNew(), &WebPMuxDelete);
    if (!mux) throw Error(ExitCode::kTemporary, "out of memory");
    VideoReader reader(part_path);
    Image last;
    Image picture;
    const auto ms = [fps](std::int64_t k) {
        return (std::int64_t{2000} * k * fps.den + fps.num) / (2 * fps.num);
    };
    for (std::int64_t k = 0; k < frames; ++k) {
        report_progress(on_progress, k, frames);
        if (!reader.read(picture))
            throw Error(ExitCode::kIo, fmt::format("'{}' changed while it was read", part_path));
        const PixelRect part = k == 0 ? picture.rect() : difference(picture, last);
        Encoded bytes;
        encode(picture, part, bytes);
        WebPMuxFrameInfo frame{};
        frame.bitstream = {bytes.writer.mem, bytes.writer.size};
        frame.x_offset = part.x0;
        frame.y_offset = part.y0;
        frame.duration = static_cast<int>(ms(k + 1) - ms(k));
        frame.id = WEBP_CHUNK_ANMF;
        frame.dispose_method = WEBP_MUX_DISPOSE_NONE;
        frame.blend_method = WEBP_MUX_NO_BLEND;
        if (WebPMuxPushFrame(mux.get(), &frame, 1) != WEBP_MUX_OK) fail_webp("takes no further frame");
        std::swap(last, picture);
    }
    const WebPMuxAnimParams forever{0, 0};
    if (WebPMuxSetAnimationParams(mux.get(), &forever) != WEBP_MUX_OK ||
        WebPMuxSetCanvasSize(mux.get(), last.width(), last.height()) != WEBP_MUX_OK)
        fail_webp("takes no picture of this size");
    WebPData whole{};
    if (WebPMuxAssemble(mux.get(), &whole) != WEBP_MUX_OK) fail_webp("does not assemble the frames");
    const int status =
        write_all(output.descriptor(), {reinterpret_cast<const char*>(whole.bytes), whole.size}, on_progress);
    WebPDataClear(&whole);
    if (status != 0) fail_file("write to", output.temporary_path(), status);
}

}  // namespace corda::media
