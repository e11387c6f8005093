#include "corda/media/encode/yuv420.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "corda/core/cpu.hpp"

namespace corda::media {
namespace {

// The BT.709 matrix times 219/255 (luma) and 224/255 (chroma) in units of 1/2^15, so that the factors of a
// product fit into 16 bits. The chroma rows sum to 0, or greys would get a tint; the luma row gives 235 for
// white.
constexpr int kShift = 15;
constexpr int kLumaR = 5983, kLumaG = 20127, kLumaB = 2032;
constexpr int kCbR = -3298, kCbG = -11094, kCbB = 14392;
constexpr int kCrR = 14393, kCrG = -13073, kCrB = -1320;
constexpr int kLumaBias = (16 << kShift) + (1 << (kShift - 1));
// A chroma sample sums 2 rows of weights 1-2-1: 8 = 2^3.
constexpr int kChromaShift = kShift + 3;
constexpr int kChromaBias = (128 << kChromaShift) + (1 << (kChromaShift - 1));

/// A pixel with R in its lowest byte. As one number, so that the loops below become SIMD code.
std::uint32_t pixel_at(const std::uint8_t* row, std::ptrdiff_t x) {
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, row + 4 * x, sizeof pixel);
    return pixel;
}

CORDA_AVX2_CLONES void luma_row(const std::uint8_t* __restrict row, int x0, int x1,
                                std::uint8_t* __restrict y) {
    for (int x = x0; x < x1; ++x) {
        const std::uint32_t p = pixel_at(row, x);
        const int sum = static_cast<int>(p & 0xffU) * kLumaR + static_cast<int>(p >> 8U & 0xffU) * kLumaG +
                        static_cast<int>(p >> 16U & 0xffU) * kLumaB;
        y[x] = static_cast<std::uint8_t>((sum + kLumaBias) >> kShift);
    }
}

/// Chroma samples of two rows of pixels. Sums of R and of B are the halves of one number.
CORDA_AVX2_CLONES void chroma_row(const std::uint8_t* __restrict upper, const std::uint8_t* __restrict lower,
                                  int i0, int i1, std::uint8_t* __restrict cb, std::uint8_t* __restrict cr) {
    constexpr std::uint32_t kMask = 0x00ff00ff;
    const auto sample = [&](std::ptrdiff_t i, std::ptrdiff_t left) {
        std::uint32_t rb = 0;
        std::uint32_t g = 0;
        for (const std::uint8_t* const row : {upper, lower}) {
            const std::uint32_t a = pixel_at(row, left);
            const std::uint32_t b = pixel_at(row, 2 * i);
            const std::uint32_t c = pixel_at(row, 2 * i + 1);
            rb += (a & kMask) + 2 * (b & kMask) + (c & kMask);
            g += (a >> 8U & 0xffU) + 2 * (b >> 8U & 0xffU) + (c >> 8U & 0xffU);
        }
        const int red = static_cast<int>(rb & 0xffffU);
        const int green = static_cast<int>(g);
        const int blue = static_cast<int>(rb >> 16U);
        cb[i] = static_cast<std::uint8_t>((red * kCbR + green * kCbG + blue * kCbB + kChromaBias) >>
                                          kChromaShift);
        cr[i] = static_cast<std::uint8_t>((red * kCrR + green * kCrG + blue * kCrB + kChromaBias) >>
                                          kChromaShift);
    };
    if (i0 == 0 && i1 > 0) sample(0, 0);  // column -1 is column 0
    for (std::ptrdiff_t i = std::max(i0, 1); i < i1; ++i) sample(i, 2 * i - 1);
}

}  // namespace

void convert_to_yuv420(const Image& rgb, const PixelRect& damage, const YuvPlanes& yuv) {
    assert(rgb.width() % 2 == 0 && rgb.height() % 2 == 0);
    const PixelRect touched = damage.intersected(rgb.rect());
    if (touched.empty()) return;
    // Sample i reads columns 2i-1 .. 2i+1, so an odd last column reaches one sample further right.
    const int i0 = touched.x0 / 2;
    const int i1 = std::min(touched.x1 / 2 + 1, rgb.width() / 2);
    const int j0 = touched.y0 / 2;
    const int j1 = (touched.y1 + 1) / 2;
    for (int j = j0; j < j1; ++j) {
        const std::uint8_t* upper = rgb.pixel(0, 2 * j);
        const std::uint8_t* lower = rgb.pixel(0, 2 * j + 1);
        std::uint8_t* y = yuv.data[0] + std::ptrdiff_t{2} * j * yuv.row_bytes[0];
        luma_row(upper, 2 * i0, 2 * i1, y);
        luma_row(lower, 2 * i0, 2 * i1, y + yuv.row_bytes[0]);
        chroma_row(upper, lower, i0, i1, yuv.data[1] + j * yuv.row_bytes[1],
                   yuv.data[2] + j * yuv.row_bytes[2]);
    }
}

void convert_to_yuv444(const Image& rgb, const PixelRect& damage, int bits, const YuvPlanes& yuv) {
    assert(bits == 8 || bits == 10);
    constexpr std::array<std::array<int, 3>, 3> kMatrix{
        {{kLumaR, kLumaG, kLumaB}, {kCbR, kCbG, kCbB}, {kCrR, kCrG, kCrB}}};
    constexpr std::array<int, 3> kZero{16, 128, 128};
    const int more = bits - 8;
    const PixelRect touched = damage.intersected(rgb.rect());
    for (int row = touched.y0; row < touched.y1; ++row) {
        for (int plane = 0; plane < 3; ++plane) {
            const auto& weights_of = kMatrix[plane];
            std::uint8_t* const line = yuv.data[plane] + row * yuv.row_bytes[plane];
            const int bias = (kZero[plane] << (kShift + more)) + (1 << (kShift - 1));
            for (int x = touched.x0; x < touched.x1; ++x) {
                const std::uint8_t* p = rgb.pixel(x, row);
                const int sum = p[0] * weights_of[0] + p[1] * weights_of[1] + p[2] * weights_of[2];
                const int value = (sum * (1 << more) + bias) >> kShift;
                if (more == 0) {
                    line[x] = static_cast<std::uint8_t>(value);
                } else {
                    line[std::ptrdiff_t{2} * x] = static_cast<std::uint8_t>(value);
                    line[std::ptrdiff_t{2} * x + 1] = static_cast<std::uint8_t>(value >> 8);
                }
            }
        }
    }
}

std::array<double, 3> rgb_from_ycbcr(double y, double cb, double cr) {
    const double luma = (y - 16.0) / 219.0;
    const double blue = (cb - 128.0) / 224.0;
    const double red = (cr - 128.0) / 224.0;
    return {255.0 * (luma + 1.5748 * red), 255.0 * (luma - 0.1873243 * blue - 0.4681243 * red),
            255.0 * (luma + 1.8556 * blue)};
}

}  // namespace corda::media
