#include "corda/render/paint.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "corda/render/coverage.hpp"

namespace corda::render {
namespace {

/// Interpolates from `top` to `bottom`, the values at the edges of the frame in 1/255 of a level. Returns the
/// value in the middle of row `y` in 1/256 of a level.
std::uint32_t level_256(int top, int bottom, int y, int height) {
    const std::int64_t halves = 2 * std::int64_t{height};  // of rows
    const std::int64_t below = 2 * std::int64_t{y} + 1;
    return static_cast<std::uint32_t>(256 * (top * (halves - below) + bottom * below) / (255 * halves));
}

/// The dither threshold of a pixel, 112 .. 143, in Bayer's order: the bits of x ^ y and y, interleaved from
/// the lowest. Two levels mix in an eighth of the rows between them, which hides the edge. Dithering all rows
/// makes x264 twice as slow, because it can skip no block early.
std::uint32_t threshold_256(unsigned x, unsigned y) {
    std::uint32_t rank = 0;
    for (unsigned bit = 0; bit < 3; ++bit)
        rank = rank << 2U | (((x ^ y) >> bit) & 1U) << 1U | ((y >> bit) & 1U);
    return 112 + rank / 2;
}

/// Pixels that are painted at a time: one period of the ground. The compiler vectorises the loops with 16-bit
/// integers.
constexpr std::size_t kPixels = GroundRows::kPeriodPx;
constexpr std::size_t kChannels = 4 * kPixels;
using Levels = std::array<std::uint8_t, kChannels>;
using Alphas = std::array<std::uint16_t, kChannels>;

/// over_255() in 16 bits, which suffice for 0 <= v <= 255 * 255.
std::uint16_t over_255_short(std::uint16_t v) {
    const auto t = static_cast<std::uint16_t>(v + 128U);
    return static_cast<std::uint16_t>(static_cast<std::uint16_t>(t + (t >> 8U)) >> 8U);
}

/// Masks for the two coverage bytes of a pixel, read as one integer.
constexpr std::uint16_t kCapsules = 0x00ff;
constexpr std::uint16_t kHalo = 0xff00;

/// True if the coverage of every pixel is 0 in the bytes that `each` selects.
bool is_zero(const std::uint8_t* coverage, std::uint16_t each) {
    std::array<std::uint64_t, 2 * kPixels / sizeof(std::uint64_t)> words{};
    std::memcpy(words.data(), coverage, sizeof(words));
    const std::uint64_t bits = each * std::uint64_t{0x0001'0001'0001'0001};
    return std::ranges::all_of(words, [bits](std::uint64_t word) { return (word & bits) == 0; });
}

/// The alphas of a mask with a stride of two bytes, repeated for all channels of a pixel.
Alphas alphas_of(const std::uint8_t* mask, std::uint8_t layer_alpha) {
    Alphas alphas;
    for (std::size_t x = 0; x < kPixels; ++x) {
        const std::uint16_t alpha = over_255_short(static_cast<std::uint16_t>(mask[2 * x] * layer_alpha));
        for (std::size_t c = 0; c < 4; ++c) alphas[4 * x + c] = alpha;
    }
    return alphas;
}

void paint(const Alphas& alphas, const std::uint8_t* own, std::uint8_t* rgba) {
    for (std::size_t i = 0; i < kChannels; ++i) {
        const auto below = static_cast<std::uint16_t>(rgba[i] * (255U - alphas[i]));
        const auto above = static_cast<std::uint16_t>(own[i] * alphas[i]);
        rgba[i] = static_cast<std::uint8_t>(over_255_short(static_cast<std::uint16_t>(below + above)));
    }
}

Levels filled(Color color) {
    Levels levels;
    for (std::size_t x = 0; x < kPixels; ++x) {
        const std::array<std::uint8_t, 4> pixel{color.r, color.g, color.b, 255};
        std::copy(pixel.begin(), pixel.end(), &levels[4 * x]);
    }
    return levels;
}

/// Writes the mean tint of each covered pixel; other pixels of the layer do not show.
void write_means(const std::uint8_t* coverage, const TintSums* sums, std::size_t count, Levels& levels) {
    for (std::size_t x = 0; x < count; ++x) {
        if (coverage[2 * x] == 0) continue;
        levels[4 * x] = static_cast<std::uint8_t>(sums[x].mean(sums[x].r));
        levels[4 * x + 1] = static_cast<std::uint8_t>(sums[x].mean(sums[x].g));
        levels[4 * x + 2] = static_cast<std::uint8_t>(sums[x].mean(sums[x].b));
    }
}

/// Paints the halo in the colours of the ground, then the capsules.
void paint_pixels(const std::uint8_t* coverage, std::uint8_t layer_alpha, const Levels& own,
                  const std::uint8_t* ground, std::uint8_t* rgba) {
    if (!is_zero(coverage, kHalo)) paint(alphas_of(coverage + 1, layer_alpha), ground, rgba);
    if (!is_zero(coverage, kCapsules)) paint(alphas_of(coverage, layer_alpha), own.data(), rgba);
}

}  // namespace

void write_ground_row(const Ground& ground, int y, int width, int height, std::uint8_t* rgba) {
    const auto& [top, bottom] = ground;
    const std::array<std::uint32_t, 4> levels{level_256(top.r * top.a, bottom.r * bottom.a, y, height),
                                              level_256(top.g * top.a, bottom.g * bottom.a, y, height),
                                              level_256(top.b * top.a, bottom.b * bottom.a, y, height),
                                              level_256(255 * top.a, 255 * bottom.a, y, height)};
    std::array<std::uint32_t, 8> thresholds{};
    for (unsigned x = 0; x < thresholds.size(); ++x)
        thresholds[x] = threshold_256(x, static_cast<unsigned>(y));
    for (int x = 0; x < width; ++x) {
        for (const std::uint32_t level : levels)
            *rgba++ = static_cast<std::uint8_t>((level + thresholds[x & 7]) >> 8U);
    }
}

GroundRows::GroundRows(const Ground& ground, int height)
    : ground_(ground), rows_(static_cast<std::size_t>(height)) {
    for (int y = 0; y < height; ++y)
        write_ground_row(ground, y, kPeriodPx, height, rows_[static_cast<std::size_t>(y)].data());
}

void GroundRows::write(const PixelRect& part, Image& image) const {
    for (int y = part.y0; y < part.y1; ++y) {
        const Row& pixels = row(y);
        std::uint8_t* rgba = image.pixel(part.x0, y);
        for (int x = part.x0; x < part.x1;) {
            const int first = x % kPeriodPx;
            const int count = std::min(kPeriodPx - first, part.x1 - x);
            std::copy_n(&pixels[std::size_t{4} * first], 4 * count, rgba);
            x += count;
            rgba += std::ptrdiff_t{4} * count;
        }
    }
}

Ground straight_ends(const Ground& ground) {
    auto [top, bottom] = ground;
    if (top.a == 0) top = {bottom.r, bottom.g, bottom.b, 0};
    if (bottom.a == 0) bottom = {top.r, top.g, top.b, 0};
    return {top, bottom};
}

void paint_run(const PixelRect& rect, Color color, const Masks& masks, const GroundRows& ground,
               Image& image) {
    Levels own = filled(color);
    for (int y = rect.y0; y < rect.y1; ++y) {
        const std::uint8_t* const bare = ground.row(y).data();
        for (int x = rect.x0; x < rect.x1; x += GroundRows::kPeriodPx) {
            const std::size_t at = static_cast<std::size_t>(y - rect.y0) * masks.row_px + x - rect.x0;
            const auto count = static_cast<std::size_t>(std::min(GroundRows::kPeriodPx, rect.x1 - x));
            std::array<std::uint8_t, 2 * kPixels> coverage{};
            std::copy_n(masks.coverage + 2 * at, 2 * count, coverage.begin());
            if (!is_zero(coverage.data(), kCapsules | kHalo)) {
                if (masks.sums != nullptr) write_means(coverage.data(), masks.sums + at, count, own);
                Levels rgba{};
                std::copy_n(image.pixel(x, y), 4 * count, rgba.begin());
                paint_pixels(coverage.data(), color.a, own, bare, rgba.data());
                std::copy_n(rgba.begin(), 4 * count, image.pixel(x, y));
            }
        }
    }
}

void paint_stamps(const view::DrawList& list, const PixelRect& part, Image& image) {
    for (const view::Stamp& stamp : list.stamps) {
        const PixelRect box = stamp.box.intersected(part);
        const std::array<std::uint8_t, 4> own{stamp.color.r, stamp.color.g, stamp.color.b, 255};
        for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
                std::uint32_t coverage = 255;
                if (stamp.first_coverage != view::Stamp::kSolid) {
                    const std::size_t row = static_cast<std::size_t>(y - stamp.box.y0) * stamp.box.width();
                    coverage = list.coverage[stamp.first_coverage + row + (x - stamp.box.x0)];
                }
                std::uint8_t* pixel = image.pixel(x, y);
                for (int c = 0; c < 4 && coverage > 0; ++c)
                    pixel[c] =
                        static_cast<std::uint8_t>(paint_over(pixel[c], own[c], stamp.color.a, coverage));
            }
        }
    }
}

void straighten(const PixelRect& part, Image& image) {
    for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x) straighten(image.pixel(x, y));
    }
}

}  // namespace corda::render
