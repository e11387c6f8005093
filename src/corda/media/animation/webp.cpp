#include <fmt/format.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <memory>

#include "corda/core/text.hpp"
#include "corda/media/animation/animation.hpp"

namespace corda::media {
namespace {

using Mux = std::unique_ptr<WebPMux, decltype(&WebPMuxDelete)>;

[[noreturn]] void fail_webp(const std::string& what) {
    throw_error(ExitCode::kEncoder, "libwebp {}; use a smaller picture or .apng", what);
}

/// A picture encoded by libwebp, with the memory that libwebp frees.
struct Encoded : NonCopyable {
    Encoded() { WebPMemoryWriterInit(&writer); }
    ~Encoded() { WebPMemoryWriterClear(&writer); }
    WebPMemoryWriter writer{};
};

/// A frame, as far as it does not depend on those before.
struct WebpFrame {
    PixelRect part;
    bool is_blended = false;
    std::unique_ptr<Encoded> bytes;  ///< of a lossless picture
};

WebpFrame encode_webp(const PictureChange& change) {
    WebpFrame frame{change.part, change.is_blended, std::make_unique<Encoded>()};
    WebPConfig config;
    WebPPicture picture;
    constexpr int kEffort = 1;  // of 9: 6, libwebp's own, takes twice the time for 10 to 14 % fewer bytes
    if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0 ||
        WebPConfigLosslessPreset(&config, kEffort) == 0)
        fail_webp("has another version");
    config.exact = 1;
    picture.use_argb = 1;
    picture.width = change.picture.width();
    picture.height = change.picture.height();
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &frame.bytes->writer;
    const bool is_done = WebPPictureImportRGBA(&picture, change.picture.data(),
                                               static_cast<int>(change.picture.row_bytes())) != 0 &&
                         WebPEncode(&config, &picture) != 0;
    const int code = picture.error_code;
    WebPPictureFree(&picture);
    if (!is_done) fail_webp(fmt::format("does not encode a frame (its error {})", code));
    return frame;
}

}  // namespace

void write_webp(const Ending& /*ending*/, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output) {
    const Mux mux(WebPMuxNew(), &WebPMuxDelete);
    if (!mux) throw Error(ExitCode::kTemporary, "out of memory");
    const auto ms = [fps = def.fps](std::int64_t k) {
        return (std::int64_t{2000} * k * fps.den + fps.num) / (2 * fps.num);
    };
    std::int64_t k = 0;
    PixelRect canvas;
    const auto add = [&](const WebpFrame& made) {
        if (k == 0) canvas = made.part;
        WebPMuxFrameInfo frame{};
        frame.bitstream = {made.bytes->writer.mem, made.bytes->writer.size};
        frame.x_offset = made.part.x0;
        frame.y_offset = made.part.y0;
        frame.duration = static_cast<int>(ms(k + 1) - ms(k));
        frame.id = WEBP_CHUNK_ANMF;
        frame.dispose_method = WEBP_MUX_DISPOSE_NONE;
        frame.blend_method = made.is_blended ? WEBP_MUX_BLEND : WEBP_MUX_NO_BLEND;
        if (WebPMuxPushFrame(mux.get(), &frame, 1) != WEBP_MUX_OK) fail_webp("takes no further frame");
        ++k;
    };
    for_each_frame<WebpFrame>(
        def, on_progress, [](const LosslessFrames& pictures) { return encode_webp(pictures.change()); }, add);
    const WebPMuxAnimParams plays{0, def.loop};
    if (WebPMuxSetAnimationParams(mux.get(), &plays) != WEBP_MUX_OK ||
        WebPMuxSetCanvasSize(mux.get(), canvas.width(), canvas.height()) != WEBP_MUX_OK)
        fail_webp("takes no picture of this size");
    WebPData whole{};
    if (WebPMuxAssemble(mux.get(), &whole) != WEBP_MUX_OK) fail_webp("does not assemble the frames");
    const std::unique_ptr<WebPData, decltype(&WebPDataClear)> clear(&whole, &WebPDataClear);
    output.write({reinterpret_cast<const char*>(whole.bytes), whole.size});
    output.flush();
}

}  // namespace corda::media
