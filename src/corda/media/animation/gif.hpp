#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "corda/core/file.hpp"
#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/animation/palette.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/frame_maker.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Makes a GIF with one palette for all frames; each frame holds the pixels that changed.
///
/// The palette follows from all frames, so that they are kept until the last one is there: as the pixels that
/// changed, in a file without a name.
class GifWriter : NonCopyable {
  public:
    /// Keeps the frames on the disk of `folder`. Throws corda::Error (kIo), like all below.
    GifWriter(const Format& format, const VideoDef& def, const std::string& folder);

    /// Adds the next frame, whose pixels are RGBA.
    void add(const ReadyFrame& frame);

    /// Chooses the palette, encodes all frames, and calls `on_frames` with how many are done. Throws
    /// kEncoder, and kInterrupted if cancelled.
    void write(const OutputFile& output, const std::function<void(std::int64_t)>& on_frames);

  private:
    /// Pixels of a row that differ from the frame before.
    struct Run {
        std::int32_t y;
        std::int32_t x;
        std::int32_t count;
    };
    void add_row(const std::uint8_t* row, int y, int x0, int x1);
    void keep(const void* bytes, std::size_t count);
    void read(void* bytes, std::size_t count);
    /// Adds the colour that a pixel has had since it changed.
    void count_pixel(std::size_t index);

    Format format_;
    VideoDef def_;
    std::string folder_;
    Image last_;                       ///< the last frame
    std::vector<std::int32_t> since_;  ///< for each pixel: the frame from which on it is as in last_
    PaletteMaker colors_;
    FileHandle kept_;  ///< for each frame its runs with their pixels, and an empty run
    std::int64_t frames_ = 0;
};

}  // namespace corda::media
