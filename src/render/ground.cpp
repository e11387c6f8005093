#include "corda/render/ground.hpp"

#include <algorithm>
#include <array>

namespace corda::render {
namespace {

/// What is `top` and `bottom`, in 1/255 of a level, at the edges of the frame, in the middle of row `y`, in
/// 1/256 of a level.
std::uint32_t level_256(int top, int bottom, int y, int height) {
    const std::int64_t halves = 2 * std::int64_t{height};  // of rows
    const std::int64_t below = 2 * std::int64_t{y} + 1;
    return static_cast<std::uint32_t>(256 * (top * (halves - below) + bottom * below) / (255 * halves));
}

/// The threshold of a pixel, 112 .. 143, in Bayer's order: the bits of x ^ y and y, interleaved from the
/// lowest on. Two levels are mixed in an eighth of the rows from one to the next, which hides the edge; a
/// dither of all rows makes x264 twice as slow, as no block can be skipped without a look.
std::uint32_t threshold_256(unsigned x, unsigned y) {
    std::uint32_t rank = 0;
    for (unsigned bit = 0; bit < 3; ++bit)
        rank = rank << 2U | (((x ^ y) >> bit) & 1U) << 1U | ((y >> bit) & 1U);
    return 112 + rank / 2;
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

}  // namespace corda::render
