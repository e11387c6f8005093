#include "corda/render/paint.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace corda::render {
namespace {

/// Pixels that are painted at a time: as many as the ground repeats after, in loops that the compiler turns
/// into vectors of 16-bit integers.
constexpr std::size_t kPixels = GroundRows::kPeriodPx;
constexpr std::size_t kChannels = 4 * kPixels;
using Levels = std::array<std::uint8_t, kChannels>;
using Alphas = std::array<std::uint16_t, kChannels>;

/// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255: over_255() in 16 bits, which hold all of
/// it.
std::uint16_t over_255_short(std::uint16_t v) {
    const auto t = static_cast<std::uint16_t>(v + 128U);
    return static_cast<std::uint16_t>(static_cast<std::uint16_t>(t + (t >> 8U)) >> 8U);
}

/// A pixel's coverage as the integer that its two bytes are.
constexpr std::uint16_t kCapsules = 0x00ff;
constexpr std::uint16_t kHalo = 0xff00;

/// Whether the bytes of all pixels' coverage are 0 that `each` has bits in.
bool is_zero(const std::uint8_t* coverage, std::uint16_t each) {
    std::array<std::uint64_t, 2 * kPixels / sizeof(std::uint64_t)> words{};
    std::memcpy(words.data(), coverage, sizeof(words));
    const std::uint64_t bits = each * std::uint64_t{0x0001'0001'0001'0001};
    return std::all_of(words.begin(), words.end(), [bits](std::uint64_t word) { return (word & bits) == 0; });
}

/// The alphas of a mask of every other byte, the same for all channels of a pixel.
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

/// Colours of pixels that a tinted layer covers; of others nothing shows.
void write_means(const std::uint8_t* coverage, const TintSums* sums, std::size_t count, Levels& levels) {
    for (std::size_t x = 0; x < count; ++x) {
        if (coverage[2 * x] == 0) continue;
        levels[4 * x] = static_cast<std::uint8_t>(sums[x].mean(sums[x].r));
        levels[4 * x + 1] = static_cast<std::uint8_t>(sums[x].mean(sums[x].g));
        levels[4 * x + 2] = static_cast<std::uint8_t>(sums[x].mean(sums[x].b));
    }
}

/// First the halo, as the ground is, then the capsules.
void paint_pixels(const std::uint8_t* coverage, std::uint8_t layer_alpha, const Levels& own,
                  const std::uint8_t* ground, std::uint8_t* rgba) {
    if (!is_zero(coverage, kHalo)) paint(alphas_of(coverage + 1, layer_alpha), ground, rgba);
    if (!is_zero(coverage, kCapsules)) paint(alphas_of(coverage, layer_alpha), own.data(), rgba);
}

}  // namespace

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

}  // namespace corda::render
