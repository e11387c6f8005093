#pragma once

#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Converts the part of `image` that `part` touches to the pixel format of `frame`, which has the same size
/// and is writable; the rest of it stays. Takes planar Y'CbCr in 4:2:0 of 8 bits or 4:4:4 of 8 or 10 bits
/// (see yuv420.hpp), with or without alpha, and packed R'G'B' of 8 bits. Alpha stays straight. Throws
/// corda::Error (kInternal) for other formats.
void convert_pixels(const Image& image, const PixelRect& part, AVFrame& frame);

/// A frame with room for its pixels, and with the tags of its pixel format. Throws corda::Error (kTemporary).
[[nodiscard]] Frame new_frame(AVPixelFormat format, int width, int height);

/// One with memory from `pool`, which is made with the first: all its frames have one format and size.
[[nodiscard]] Frame new_frame(AVPixelFormat format, int width, int height, BufferPool& pool);

/// Sets the colour tags that a frame or a context of this pixel format gets: BT.709 in limited range with the
/// sRGB transfer, or sRGB in R'G'B'.
template <typename Tagged>
void set_colors(AVPixelFormat format, Tagged& tagged) {
    const bool is_rgb =
        (av_pix_fmt_desc_get(format)->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) != 0;
    tagged.color_range = is_rgb ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    tagged.colorspace = is_rgb ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    tagged.color_primaries = AVCOL_PRI_BT709;
    // The bt709 transfer tag would be truer to the matrix and wrong on the screen: Safari and QuickTime wash
    // it out.
    tagged.color_trc = AVCOL_TRC_IEC61966_2_1;
}

/// Where the colour of 4:2:0 is sited; unspecified for others.
[[nodiscard]] inline AVChromaLocation chroma_location(AVPixelFormat format) {
    return av_pix_fmt_desc_get(format)->log2_chroma_w == 1 ? AVCHROMA_LOC_LEFT : AVCHROMA_LOC_UNSPECIFIED;
}

/// Pictures whose transparent pixels have the colour of the nearest pixels that show. What is there unseen
/// would darken the edges: 4:2:0 has one colour for four pixels, and a lossy codec spreads a jump over a
/// block.
class AlphaBleed {
  public:
    /// How far colours are spread.
    static constexpr int kReachPx = 4;
    /// Pixels of less alpha get another colour: their own, divided by so small an alpha, is imprecise.
    static constexpr int kMinAlpha = 32;

    /// Takes the part of a picture that differs from the last one, or all of another size; returns what of
    /// picture() that changes.
    PixelRect update(const Image& image, const PixelRect& part);
    [[nodiscard]] const Image& picture() const { return picture_; }

  private:
    struct Found {
        std::uint8_t r = 0, g = 0, b = 0;
        std::uint8_t distance = 0;  ///< in the row, in pixels; kReachPx + 1: there is none
    };
    void search_row(const Image& image, int y, const PixelRect& grown, Found* row) const;

    Image picture_;
    std::vector<Found> rows_;  ///< of the part, in its columns
};

}  // namespace corda::media
