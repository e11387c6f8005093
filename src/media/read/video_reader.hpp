#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/encode/yuv420.hpp"
#include "corda/media/read/stored_video.hpp"

namespace corda::media {

/// Reads the pictures of a video in the order in which a player shows them.
class VideoReader {
  public:
    /// Reads a file, or its first `bytes`. Throws corda::Error (kIo) if it is not a video that can be
    /// decoded.
    explicit VideoReader(const std::string& path, std::optional<std::uint64_t> bytes = {});
    VideoReader(const VideoReader&) = delete;
    VideoReader& operator=(const VideoReader&) = delete;
    ~VideoReader();

    /// Frames per second as the file tells them; 0/1 if it does not.
    [[nodiscard]] Rational rate() const;

    /// Puts the next picture into `picture`; false after the last one. Throws corda::Error (kIo) for a
    /// picture that does not decode cleanly, or has a palette or more than 16 bits.
    [[nodiscard]] bool read(StoredPicture& picture);

    /// Whether the picture that was read last may be transparent.
    [[nodiscard]] bool has_alpha() const;

    /// Puts the next picture into `picture`, which gets the video's size; false after the last one. Throws
    /// corda::Error (kIo) for a picture that does not decode cleanly or is not yuv420p with even sides.
    [[nodiscard]] bool read(Yuv420Image& picture);

    /// The same for a video of exact pictures: throws for one that copy_exact() does not take.
    [[nodiscard]] bool read(Image& picture);

    /// Leaves the next picture out. Throws as read() does, also after the last one.
    void skip();

    /// The next picture as a player shows it, whatever its pixel format: 8-bit RGBA, straight alpha. Throws
    /// for one that does not decode cleanly.
    [[nodiscard]] bool read_shown(Image& picture);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace corda::media
