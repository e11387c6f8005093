#pragma once

#include <cstdint>
#include <string>

#include "corda/core/image.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Reads back a video that this process has just written to `path`: the number of its frames, their times,
/// which have a constant step (in containers that count milliseconds or hundredths of a second, are the
/// nearest ones), the duration, the colour tags, the index before the pictures (MP4, QuickTime), and the
/// colours of the first picture, which is decoded and compared with `first`, the drawn one, where it has no
/// edges. Throws corda::Error: kEncoder with the first thing that is wrong, kIo, kInterrupted if cancelled.
void check_video(const std::string& path, const Format& format, const VideoDef& def, std::int64_t frames,
                 const Image& first);

}  // namespace corda::media
