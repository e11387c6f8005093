#pragma once

#include <memory>
#include <string>

#include "corda/core/image.hpp"
#include "corda/media/yuv420.hpp"

namespace corda::media {

/// Reads the pictures of a video in the order in which a player shows them.
class VideoReader {
  public:
    /// Throws corda::Error (kIo) if the file is not a video that can be decoded.
    explicit VideoReader(const std::string& path);
    VideoReader(const VideoReader&) = delete;
    VideoReader& operator=(const VideoReader&) = delete;
    ~VideoReader();

    /// Whether the picture that was read last may be transparent.
    [[nodiscard]] bool has_alpha() const;

    /// Puts the next picture into `picture`, which gets the video's size; false after the last one. Throws
    /// corda::Error (kIo) for a picture that does not decode cleanly or is not yuv420p with even sides.
    [[nodiscard]] bool read(Yuv420Image& picture);

    /// The same for a video of exact pictures: throws for one that is not bgr0 or bgra.
    [[nodiscard]] bool read(Image& picture);

    /// The next picture as a player shows it, whatever its pixel format: 8-bit RGBA, straight alpha. Throws
    /// for one that does not decode cleanly.
    [[nodiscard]] bool read_shown(Image& picture);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace corda::media
