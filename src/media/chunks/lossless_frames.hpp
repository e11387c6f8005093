#pragma once

#include <cstdint>
#include <string>

#include "corda/core/image.hpp"
#include "corda/media/read/video_reader.hpp"

namespace corda::media {

/// Changes of an animation frame.
struct PictureChange {
    /// Where the frame differs from the last one, from even columns and rows on; one pixel if it does not.
    PixelRect part;
    /// That part of the frame. If it is to be blended over the last frame, pixels that stay as they are have
    /// no colour and are transparent, which takes fewer bytes.
    Image picture;
    bool is_blended = false;
};

/// The exact pictures of a part, one after the other, and what each of them changes.
class LosslessFrames {
  public:
    /// Reads the first `bytes` of a part. Throws corda::Error (kIo), like all below.
    LosslessFrames(std::string part_path, std::uint64_t bytes);

    /// Goes on to picture `k`, which must come after the current one.
    void go_to(std::int64_t k);
    [[nodiscard]] const Image& picture() const { return picture_; }
    /// Of the picture before; of picture 0, all. Opaque pictures are blended.
    [[nodiscard]] PictureChange change() const;
    /// Whether pictures may be transparent.
    [[nodiscard]] bool has_alpha() const { return reader_.has_alpha(); }

  private:
    void read(Image& picture);

    std::string part_path_;
    VideoReader reader_;
    std::int64_t next_ = 0;
    Image picture_;
    Image last_;  ///< the one before
};

}  // namespace corda::media
