#pragma once

#include <cstdint>
#include <string>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// A drawn frame as a VideoFile takes it.
struct ReadyFrame {
    std::int64_t number = 0;  ///< in the film
    Frame pixels{};           ///< in the pixel format of the video; null of a picture
    Damage changed{};         ///< what may differ from the frame before
    std::string file{};       ///< of a picture: the bytes of its file
    Image drawn{};            ///< the first frame of a video as it was drawn; of others empty
};

/// Makes drawn frames ready for a VideoFile: the work that needs no other frame, so that several threads can
/// do it, each with a maker of its own.
class FrameMaker : NonCopyable {
  public:
    /// For a video whose first frame is `first`. A picture file says what `info` tells.
    FrameMaker(const Format& format, std::int64_t first, PictureInfo info);

    /// Frame `k`: `image` inside `damage`, and the frame that this maker made last elsewhere. The first one
    /// is taken whole. Throws corda::Error (kTemporary).
    [[nodiscard]] ReadyFrame make(std::int64_t k, const Image& image, const Damage& damage);

  private:
    Format format_;
    std::int64_t first_;
    PictureInfo info_;
    AlphaBleed bleed_;        ///< of 4:2:0 with alpha
    BufferPool pool_;         ///< of frames: memory that the system takes back costs as much as converting
    Frame frame_;             ///< the one made last; copies are given away, which another thread reads
    std::int64_t last_ = -1;  ///< the number of frame_
};

}  // namespace corda::media
