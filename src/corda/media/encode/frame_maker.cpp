#include "corda/media/encode/frame_maker.hpp"

#include <span>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/media/bytes.hpp"

namespace corda::media {

FrameMaker::FrameMaker(const Format& format, std::int64_t first, PictureInfo info)
    : format_(format), first_(first), info_(std::move(info)) {}

ReadyFrame FrameMaker::make(std::int64_t k, const Image& image, const Damage& damage) {
    ReadyFrame ready;
    ready.number = k;
    if (format_.ending->kind == FileKind::kPictures) {
        const CancelScope whole({}, CancelScope::Outer::kIgnored);  // half a picture is of no use
        ready.file = png_bytes(image, info_ ? info_(k) : PngInfo{});
        return ready;
    }
    if (k == first_) ready.drawn = image;
    const LogCapture log;
    const PixelRect whole = image.rect();
    const auto format = av_get_pix_fmt(format_.pixel_format);
    const auto parts = frame_ ? std::span(damage) : std::span(&whole, 1);
    if (!frame_) frame_ = new_frame(format, image.width(), image.height());
    const bool bleeds = std::string_view(format_.pixel_format) == "yuva420p";
    for (const PixelRect& part : parts) {
        ready.changed.push_back(bleeds ? bleed_.update(image, part) : part);
        convert_pixels(bleeds ? bleed_.picture() : image, ready.changed.back(), *frame_);
    }
    if (k != last_ + 1) ready.changed = {whole};
    last_ = k;
    ready.pixels = new_frame(format, image.width(), image.height(), pool_);
    check_libav(av_frame_copy(ready.pixels.get(), frame_.get()), ExitCode::kTemporary,
                "cannot copy a picture");
    return ready;
}

}  // namespace corda::media
