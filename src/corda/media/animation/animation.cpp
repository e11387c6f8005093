#include "corda/media/animation/animation.hpp"

#include <cassert>

#include "corda/core/text.hpp"
#include "corda/media/encode/pixels.hpp"

namespace corda::media {

void LosslessFrames::decode() {
    if (next_ == end_) {
        end_ += chunks_[chunk_].frames;
        decoder_.emplace(chunks_[chunk_++].path);
    }
    if (!decoder_->read())
        throw_error(ExitCode::kIo, "'{}' changed while it was read", chunks_[chunk_ - 1].path);
    ++next_;
}

void LosslessFrames::go_to(std::int64_t k) {
    assert(k >= next_);
    if (k >= end_) next_ = end_;
    for (; chunk_ < chunks_.size() && k >= end_ + chunks_[chunk_].frames; ++chunk_) {
        end_ += chunks_[chunk_].frames;
        next_ = end_;
    }
    while (next_ <= k) decode();
    if (!copy_exact(decoder_->frame(), picture_))
        throw_error(ExitCode::kIo, "'{}' holds no lossless R'G'B'", chunks_[chunk_ - 1].path);
}

}  // namespace corda::media
