#include "corda/media/animation/animation.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "corda/core/text.hpp"
#include "corda/media/encode/pixels.hpp"

namespace corda::media {
namespace {

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

}  // namespace

void LosslessFrames::enter(std::int64_t k) {
    if (k < end_) return;
    while (k >= end_) {
        next_ = end_;
        end_ += chunks_[chunk_++].frames;
    }
    decoder_.emplace(chunks_[chunk_ - 1].path);
}

void LosslessFrames::decode() {
    if (!decoder_->read())
        throw_error(ExitCode::kIo, "'{}' changed while it was read", chunks_[chunk_ - 1].path);
    ++next_;
}

void LosslessFrames::read(Image& picture) {
    enter(next_);
    decode();
    if (!copy_exact(decoder_->frame(), picture))
        throw_error(ExitCode::kIo, "'{}' holds no lossless R'G'B'", chunks_[chunk_ - 1].path);
}

void LosslessFrames::go_to(std::int64_t k) {
    assert(k >= next_);
    const std::int64_t before = std::max<std::int64_t>(0, k - 1);
    enter(before);
    while (next_ < before) decode();
    if (next_ < k) read(picture_);
    std::swap(last_, picture_);
    read(picture_);
}

PictureChange LosslessFrames::change() const {
    if (next_ == 1) return {picture_.rect(), picture_, false};
    PictureChange change;
    change.part = difference(picture_, last_);
    const auto format = static_cast<AVPixelFormat>(decoder_->frame().format);
    change.is_blended = (av_pix_fmt_desc_get(format)->flags & AV_PIX_FMT_FLAG_ALPHA) == 0;
    change.picture = Image(change.part.width(), change.part.height());
    for (int y = 0; y < change.part.height(); ++y) {
        const std::uint8_t* const from = picture_.pixel(change.part.x0, change.part.y0 + y);
        const std::uint8_t* const before = last_.pixel(change.part.x0, change.part.y0 + y);
        std::uint8_t* const to = change.picture.pixel(0, y);
        std::memcpy(to, from, change.picture.row_bytes());
        if (!change.is_blended) continue;
        for (int x = 0; x < 4 * change.part.width(); x += 4)
            if (std::memcmp(from + x, before + x, 4) == 0) std::memset(to + x, 0, 4);
    }
    return change;
}

void check_animation_frames(const Ending& ending, std::int64_t frames) {
    if (ending.kind != FileKind::kAnimation || frames != 1 || find_codec(ending.muxer)->min_frames == 1)
        return;
    throw_usage("{} holds one frame as a picture, which has no duration; use .apng, or .png (corda still)",
                ending.words);
}

void write_animation(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                     OutputFile& output) {
    check_animation_frames(ending, def.frames);
    find_codec(ending.muxer)->write(ending, def, on_progress, output);
}

}  // namespace corda::media
