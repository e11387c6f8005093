#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::media {

/// A picture in planar Y'CbCr 4:2:0, BT.709 limited range, chroma sited left. Sides are even.
class Yuv420Image {
  public:
    Yuv420Image() = default;
    Yuv420Image(int width, int height);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    /// Plane 0 is Y' (width x height bytes); 1 and 2 are Cb and Cr (half of each side). No padding.
    [[nodiscard]] const std::uint8_t* plane(int index) const { return planes_[index].data(); }
    [[nodiscard]] std::uint8_t* plane(int index) { return planes_[index].data(); }
    [[nodiscard]] int plane_width(int index) const { return index == 0 ? width_ : width_ / 2; }
    [[nodiscard]] int plane_height(int index) const { return index == 0 ? height_ : height_ / 2; }

    friend bool operator==(const Yuv420Image&, const Yuv420Image&) = default;

  private:
    int width_ = 0;
    int height_ = 0;
    std::array<std::vector<std::uint8_t>, 3> planes_;
};

/// Converts the part of `rgb` that `damage` touches; the rest of `yuv` stays. Converting only what has
/// changed since the last call gives the same bytes as converting the whole picture. Alpha is ignored. Both
/// pictures have the same size with even sides.
///
/// Y' = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B), Cb and Cr as in ITU-R BT.709-6, sections 3 and 4.6 (8
/// bit), in integers. A chroma sample is sited at the left column of its 2x2 pixels: weights 1-2-1 over
/// columns 2i-1, 2i, 2i+1 (the edge column repeated) and 1-1 over the two rows.
void convert_to_yuv420(const Image& rgb, const PixelRect& damage, Yuv420Image& yuv);

/// The three planes of a picture in borrowed memory.
struct YuvPlanes {
    std::array<std::uint8_t*, 3> data{};
    std::array<std::ptrdiff_t, 3> row_bytes{};
};

/// The same for planes of the size that `rgb` has.
void convert_to_yuv420(const Image& rgb, const PixelRect& damage, const YuvPlanes& yuv);

/// As convert_to_yuv420, in full resolution, which takes any size. `bits`: 8, or 10 in two bytes per sample,
/// the lower one first.
void convert_to_yuv444(const Image& rgb, const PixelRect& damage, int bits, const YuvPlanes& yuv);

}  // namespace corda::media
