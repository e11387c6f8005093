#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/yuv420.hpp"

namespace corda::media {

/// A picture of a video as it is stored: of any kind that libav decodes, but for palettes.
struct StoredPicture {
    int width_px = 0;
    int height_px = 0;
    std::string format;                  ///< libav's name of the pixel format
    double time_s = 0.0;                 ///< when a player shows it
    std::vector<std::uint16_t> samples;  ///< component after component, each in rows
    // What the samples mean.
    int components = 0;  ///< 1: grey; 3; 4: with alpha
    bool is_rgb = false;
    bool is_full_range = false;
    int bits = 8;
    int chroma_shift_x = 0;  ///< of Cb and Cr
    int chroma_shift_y = 0;

    /// In 8-bit R'G'B', for Y'CbCr by the matrix of BT.709.
    [[nodiscard]] Image rgba() const;
};

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
