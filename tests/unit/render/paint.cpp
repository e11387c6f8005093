#include "corda/render/paint.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace corda::render {
namespace {

using Random = std::mt19937;  // the same numbers with every C++ library

std::uint8_t byte(Random& random) {
    return static_cast<std::uint8_t>(random() >> 24U);
}

/// Mostly 0 or 255, like real coverage, so that both shortcuts are taken.
std::uint8_t coverage(Random& random) {
    const std::uint8_t kind = byte(random);
    return kind < 128 ? std::uint8_t{0} : (kind < 160 ? std::uint8_t{255} : byte(random));
}

Color color(Random& random) {
    return {byte(random), byte(random), byte(random), byte(random)};
}

struct OwnMasks {
    std::vector<std::uint8_t> coverage;
    std::vector<TintSums> sums;
};

OwnMasks masks_of(Random& random, std::size_t pixels, bool is_tinted) {
    OwnMasks masks;
    for (std::size_t i = 0; i < 2 * pixels; ++i)
        masks.coverage.push_back(i % 2 == 1 && pixels % 3 == 0 ? std::uint8_t{0} : coverage(random));
    if (!is_tinted) return masks;
    for (std::size_t i = 0; i < pixels; ++i) {
        TintSums& sums = masks.sums.emplace_back();
        for (int links = byte(random) % 3; links >= 0; --links)
            sums.add({byte(random), byte(random), byte(random)}, 1U + byte(random));
    }
    return masks;
}

/// Paints like the reference renderer.
void paint_pixel(Color own, const std::uint8_t* mask, const std::uint8_t* bare, std::uint8_t* pixel) {
    const std::array<std::uint8_t, 4> channels{own.r, own.g, own.b, 255};
    for (int c = 0; c < 4; ++c) {
        const std::uint32_t below = paint_over(pixel[c], bare[c], own.a, mask[1]);
        pixel[c] = static_cast<std::uint8_t>(paint_over(below, channels[c], own.a, mask[0]));
    }
}

void expect_painted(Random& random, const PixelRect& rect, const Ground& ground, bool is_tinted) {
    constexpr int kWidth = 45;  // not a multiple of 8 pixels
    constexpr int kHeight = 16;
    const GroundRows rows(ground, kHeight);
    const Color own = color(random);
    const int row_px = rect.width() + 5;  // the masks are those of a larger rectangle
    const OwnMasks masks = masks_of(random, static_cast<std::size_t>(row_px) * rect.height(), is_tinted);
    Image image(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int i = 0; i < 4 * kWidth; ++i) image.pixel(0, y)[i] = byte(random);
    Image expected = image;
    for (int y = rect.y0; y < rect.y1; ++y) {
        for (int x = rect.x0; x < rect.x1; ++x) {
            const std::size_t i = static_cast<std::size_t>(y - rect.y0) * row_px + x - rect.x0;
            Color its = own;
            if (is_tinted) {
                const TintSums& sums = masks.sums[i];
                its = {static_cast<std::uint8_t>(sums.mean(sums.r)),
                       static_cast<std::uint8_t>(sums.mean(sums.g)),
                       static_cast<std::uint8_t>(sums.mean(sums.b)), own.a};
            }
            paint_pixel(its, &masks.coverage[2 * i], &rows.row(y)[4 * (x % GroundRows::kPeriodPx)],
                        expected.pixel(x, y));
        }
    }
    paint_run(rect, own,
              {.coverage = masks.coverage.data(),
               .sums = is_tinted ? masks.sums.data() : nullptr,
               .row_px = row_px},
              rows, image);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 4; ++c)
                ASSERT_EQ(image.pixel(x, y)[c], expected.pixel(x, y)[c]) << x << ',' << y << ',' << c;
}

TEST(PaintRun, EqualsPaintingEachPixel) {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Ground ground{color(random), color(random)};
        for (const bool is_tinted : {false, true}) {
            expect_painted(random, {0, 0, 45, 16}, ground, is_tinted);
            expect_painted(random, {16, 3, 32, 4}, ground, is_tinted);
            expect_painted(random, {32, 0, 45, 16}, ground, is_tinted);
        }
    }
}

TEST(PaintRun, LeavesUncoveredPixelsUnchanged) {
    Random random(2);
    Image image(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int i = 0; i < 64; ++i) image.pixel(0, y)[i] = byte(random);
    const Image before = image;
    const std::vector<std::uint8_t> none(std::size_t{2} * 16 * 16);
    paint_run(image.rect(), {255, 0, 0, 255}, {.coverage = none.data(), .row_px = 16}, GroundRows({}, 16),
              image);
    EXPECT_EQ(image, before);
}

std::vector<std::uint8_t> row(const Ground& ground, int y, int width, int height) {
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width) * 4);
    write_ground_row(ground, y, width, height, rgba.data());
    return rgba;
}

TEST(Ground, OfOneColourIsUniform) {
    for (const Color color : {Color{0, 0, 0}, {18, 22, 31}, {255, 255, 255}}) {
        for (const int y : {0, 1, 7, 16383}) {
            for (int x = 0; x < 16; ++x) {
                const auto rgba = row({color, color}, y, 16, 16384);
                EXPECT_EQ((Color{rgba[4 * x], rgba[4 * x + 1], rgba[4 * x + 2], rgba[4 * x + 3]}), color);
            }
        }
    }
}

TEST(Ground, IsPremultiplied) {
    const auto rgba = row({{255, 128, 0, 0}, {255, 128, 0, 128}}, 15, 8, 16);
    EXPECT_EQ(rgba[3], 124);
    EXPECT_EQ(rgba[0], rgba[3]);
    EXPECT_NEAR(rgba[1], 62, 1);
    EXPECT_EQ(rgba[2], 0);
}

TEST(Ground, ChangesEvenlyFromTopToBottom) {
    const Ground ground{{14, 19, 200}, {27, 36, 56}};
    constexpr int kHeight = 1080;
    constexpr int kBlock = 8;
    for (int y = 0; y < kHeight; y += kBlock) {
        double mean = 0.0;
        double mean_blue = 0.0;
        for (int i = 0; i < kBlock; ++i) {
            const auto rgba = row(ground, y + i, kBlock, kHeight);
            for (int x = 0; x < kBlock; ++x) {
                mean += rgba[4 * x] / 64.0;
                mean_blue += rgba[4 * x + 2] / 64.0;
            }
        }
        const double share = (y + 0.5 * kBlock) / kHeight;
        EXPECT_NEAR(mean, 14.0 + 13.0 * share, 1.0) << y;
        EXPECT_NEAR(mean_blue, 200.0 - 144.0 * share, 1.0) << y;
    }
}

TEST(Ground, DithersInAnEighthOfTheRows) {
    const auto high = [](int y) {
        const auto rgba = row({{10, 0, 0}, {11, 0, 0}}, y, 8, 32);
        int count = 0;
        for (int x = 0; x < 8; ++x) count += rgba[4 * x] - 10;
        return count;
    };
    for (int y = 0; y < 14; ++y) EXPECT_EQ(high(y), 0) << y;
    EXPECT_GT(high(15), 0);
    EXPECT_LT(high(15), 8);
    for (int y = 18; y < 32; ++y) EXPECT_EQ(high(y), 8) << y;
}

}  // namespace
}  // namespace corda::render
