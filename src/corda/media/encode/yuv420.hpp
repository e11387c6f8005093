#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "corda/core/image.hpp"

namespace corda::media {

/// The three planes of a picture in borrowed memory.
struct YuvPlanes {
    std::array<std::uint8_t*, 3> data{};
    std::array<std::ptrdiff_t, 3> row_bytes{};
};

/// Converts the part of `rgb` that `damage` touches to planar Y'CbCr 4:2:0, BT.709 limited range; the rest of
/// `yuv` stays. Converting only the changes since the last call gives the same bytes as converting the
/// whole picture. Alpha is ignored. The sides of `rgb` are even.
///
/// Y' = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B), Cb and Cr as in ITU-R BT.709-6, sections 3 and 4.6 (8
/// bit), in integers. A chroma sample is sited at the left column of its 2x2 pixels: weights 1-2-1 over
/// columns 2i-1, 2i, 2i+1 (the edge column repeated) and 1-1 over the two rows.
void convert_to_yuv420(const Image& rgb, const PixelRect& damage, const YuvPlanes& yuv);

/// As convert_to_yuv420, in full resolution, which takes any size. `bits`: 8, or 10 in two bytes per sample,
/// the lower one first.
void convert_to_yuv444(const Image& rgb, const PixelRect& damage, int bits, const YuvPlanes& yuv);

/// The inverse: R'G'B' (0 .. 255, not clipped) of BT.709 Y'CbCr in units of 8 bits, in limited range.
[[nodiscard]] std::array<double, 3> rgb_from_ycbcr(double y, double cb, double cr);

}  // namespace corda::media
