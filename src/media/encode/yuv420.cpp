#include "corda/media/encode/yuv420.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

std::uint8_t luma(const std::uint8_t* p) {
    return static_cast<std::uint8_t>((p[0] * kLumaR + p[1] * kLumaG + p[2] * kLumaB + kLumaBias) >> kShift);
}

/// One chroma pair from pixel column `x` (even) of two rows; column -1 is column 0.
void chroma(const std::uint8_t* upper, const std::uint8_t* lower, int x, std::uint8_t* cb, std::uint8_t* cr) {
    const int left = std::max(x - 1, 0) * 4;
    const int middle = x * 4;
    const int right = middle + 4;
    std::array<int, 3> sum{};
    for (int c = 0; c < 3; ++c) {
        sum[c] = upper[left + c] + 2 * upper[middle + c] + upper[right + c] + lower[left + c] +
                 2 * lower[middle + c] + lower[right + c];
    }
    *cb = static_cast<std::uint8_t>((sum[0] * kCbR + sum[1] * kCbG + sum[2] * kCbB + kChromaBias) >>
                                    kChromaShift);
    *cr = static_cast<std::uint8_t>((sum[0] * kCrR + sum[1] * kCrG + sum[2] * kCrB + kChromaBias) >>
                                    kChromaShift);
}

#if defined(__SSE2__)

// SSE2 is part of every x86-64, so this needs no dispatch. A pixel stays in one 32-bit lane: masking it
// leaves R and B as two 16-bit numbers, shifting it first leaves G, and one pmaddwd for each multiplies and
// adds. The integers are those of the scalar code, which converts the borders, so both give the same bytes.
struct PixelWeights {
    __m128i rb;
    __m128i g;
};

PixelWeights weights(int r, int g, int b) {
    return {_mm_set1_epi32(
                static_cast<int>((static_cast<unsigned>(b) << 16) | (static_cast<unsigned>(r) & 0xffffU))),
            _mm_set1_epi32(static_cast<int>(static_cast<unsigned>(g) & 0xffffU))};
}

__m128i weighted_sum(__m128i rb, __m128i g, const PixelWeights& w) {
    return _mm_add_epi32(_mm_madd_epi16(rb, w.rb), _mm_madd_epi16(g, w.g));
}

__m128i load(const std::uint8_t* p) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}

__m128i luma4(__m128i pixels, const PixelWeights& w, __m128i mask, __m128i bias) {
    const __m128i rb = _mm_and_si128(pixels, mask);
    const __m128i g = _mm_and_si128(_mm_srli_epi32(pixels, 8), mask);
    return _mm_srli_epi32(_mm_add_epi32(weighted_sum(rb, g, w), bias), kShift);
}

/// Luma of as many whole groups of 16 pixels as fit; returns the first column not done.
int luma_row_simd(const std::uint8_t* rgba, int x0, int x1, std::uint8_t* y) {
    const PixelWeights w = weights(kLumaR, kLumaG, kLumaB);
    const __m128i mask = _mm_set1_epi32(0x00ff00ff);
    const __m128i bias = _mm_set1_epi32(kLumaBias);
    int x = x0;
    for (; x + 16 <= x1; x += 16) {
        const std::uint8_t* p = rgba + std::ptrdiff_t{x} * 4;
        const __m128i low =
            _mm_packs_epi32(luma4(load(p), w, mask, bias), luma4(load(p + 16), w, mask, bias));
        const __m128i high =
            _mm_packs_epi32(luma4(load(p + 32), w, mask, bias), luma4(load(p + 48), w, mask, bias));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(y + x), _mm_packus_epi16(low, high));
    }
    return x;
}

/// Even (or odd) lanes of eight neighbouring pixels.
template <int kSelect>
__m128i every_second(__m128i low, __m128i high) {
    return _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(low), _mm_castsi128_ps(high), kSelect));
}

struct PixelSums {
    __m128i rb;
    __m128i g;
};

/// The 1-2-1 sums of one row around columns x, x+2, x+4, x+6; reads columns x-1 .. x+7.
PixelSums sums_1_2_1(const std::uint8_t* row, int x, __m128i mask) {
    constexpr int kEven = _MM_SHUFFLE(2, 0, 2, 0);
    constexpr int kOdd = _MM_SHUFFLE(3, 1, 3, 1);
    const std::uint8_t* p = row + std::ptrdiff_t{x} * 4;
    const __m128i low = load(p);
    const __m128i high = load(p + 16);
    const __m128i left = every_second<kEven>(load(p - 4), load(p + 12));
    const __m128i middle = every_second<kEven>(low, high);
    const __m128i right = every_second<kOdd>(low, high);
    const auto sum = [mask](__m128i a, __m128i b, __m128i c) {
        const __m128i twice = _mm_slli_epi16(_mm_and_si128(b, mask), 1);
        return _mm_add_epi16(_mm_add_epi16(_mm_and_si128(a, mask), _mm_and_si128(c, mask)), twice);
    };
    return {sum(left, middle, right),
            sum(_mm_srli_epi32(left, 8), _mm_srli_epi32(middle, 8), _mm_srli_epi32(right, 8))};
}

/// Four chroma samples as bytes in the low 32 bits.
int chroma4(const PixelSums& sums, const PixelWeights& w, __m128i bias) {
    const __m128i value = _mm_srli_epi32(_mm_add_epi32(weighted_sum(sums.rb, sums.g, w), bias), kChromaShift);
    const __m128i words = _mm_packs_epi32(value, value);
    return _mm_cvtsi128_si32(_mm_packus_epi16(words, words));
}

/// Chroma of as many whole groups of 4 samples as fit from sample `i0` > 0 on; returns the first sample not
/// done.
int chroma_row_simd(const std::uint8_t* upper, const std::uint8_t* lower, int i0, int i1, std::uint8_t* cb,
                    std::uint8_t* cr) {
    const PixelWeights cb_weights = weights(kCbR, kCbG, kCbB);
    const PixelWeights cr_weights = weights(kCrR, kCrG, kCrB);
    // The upper half of G's lane holds alpha, whose weight is 0.
    const __m128i mask = _mm_set1_epi32(0x00ff00ff);
    const __m128i bias = _mm_set1_epi32(kChromaBias);
    int i = i0;
    for (; i + 4 <= i1; i += 4) {
        const PixelSums a = sums_1_2_1(upper, 2 * i, mask);
        const PixelSums b = sums_1_2_1(lower, 2 * i, mask);
        const PixelSums both{_mm_add_epi16(a.rb, b.rb), _mm_add_epi16(a.g, b.g)};
        const int four_cb = chroma4(both, cb_weights, bias);
        const int four_cr = chroma4(both, cr_weights, bias);
        std::memcpy(cb + i, &four_cb, 4);
        std::memcpy(cr + i, &four_cr, 4);
    }
    return i;
}

#else

int luma_row_simd(const std::uint8_t*, int x0, int, std::uint8_t*) {
    return x0;
}
int chroma_row_simd(const std::uint8_t*, const std::uint8_t*, int i0, int, std::uint8_t*, std::uint8_t*) {
    return i0;
}

#endif

void luma_row(const std::uint8_t* rgba, int x0, int x1, std::uint8_t* y) {
    for (int x = luma_row_simd(rgba, x0, x1, y); x < x1; ++x) y[x] = luma(rgba + std::ptrdiff_t{x} * 4);
}

void chroma_row(const std::uint8_t* upper, const std::uint8_t* lower, int i0, int i1, std::uint8_t* cb,
                std::uint8_t* cr) {
    int i = i0;
    if (i == 0 && i < i1) {
        chroma(upper, lower, 0, cb, cr);
        i = 1;
    }
    for (i = chroma_row_simd(upper, lower, i, i1, cb, cr); i < i1; ++i) {
        chroma(upper, lower, 2 * i, cb + i, cr + i);
    }
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

std::array<double, 3> rgb_from_ycbcr(double y, double cb, double cr, bool is_full_range) {
    const double luma = is_full_range ? y / 255.0 : (y - 16.0) / 219.0;
    const double blue = (cb - 128.0) / (is_full_range ? 255.0 : 224.0);
    const double red = (cr - 128.0) / (is_full_range ? 255.0 : 224.0);
    return {255.0 * (luma + 1.5748 * red), 255.0 * (luma - 0.1873243 * blue - 0.4681243 * red),
            255.0 * (luma + 1.8556 * blue)};
}

}  // namespace corda::media
