#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"

namespace corda::media {

/// The samples of a subsampled component along a side.
[[nodiscard]] constexpr int ceiling_shift(int side_px, int shift) {
    return (side_px + (1 << shift) - 1) >> shift;
}

/// A picture of a video as it is stored: of any pixel format but palettes.
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

/// Reads the pictures of a video of any kind that Corda writes as they are stored, in the order in which a
/// player shows them.
class StoredVideo : NonCopyable {
  public:
    /// Loads the libraries that decode. Call it before a fork whose child reads videos. Throws corda::Error:
    /// kEncoder if they are missing, kTemporary if memory is short.
    static void load_libraries();

    /// Throws corda::Error (kIo) if the file is not a video that can be decoded, or breaks off before its
    /// end.
    explicit StoredVideo(const std::string& path);
    ~StoredVideo();

    /// Frames per second; 0/1 if the file does not tell them.
    [[nodiscard]] Rational rate() const;

    /// Puts the next picture into `picture`; false after the last one. Throws corda::Error (kIo) for one that
    /// does not decode cleanly, or has a palette or more than 16 bits.
    [[nodiscard]] bool read(StoredPicture& picture);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace corda::media
