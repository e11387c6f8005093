#include "corda/media/animation/palette.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace corda::media {
namespace {

constexpr int kSide = 256;

/// A dark ground from top to bottom, with a column of many other colours beside it.
Image ground_and_colors() {
    Image image(kSide + 8, kSide);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide + 8; ++x) {
            std::uint8_t* const p = image.pixel(x, y);
            const auto ground = [y](int top, int bottom) {
                return static_cast<std::uint8_t>(top + (bottom - top) * y / (kSide - 1));
            };
            p[0] = x < kSide ? ground(14, 27) : static_cast<std::uint8_t>(y);
            p[1] = x < kSide ? ground(19, 36) : static_cast<std::uint8_t>(32 * (x - kSide));
            p[2] = x < kSide ? ground(32, 56) : static_cast<std::uint8_t>(255 - y);
            p[3] = 255;
        }
    }
    return image;
}

Palette palette_of(const Image& image) {
    PaletteMaker maker;
    for (std::size_t i = 0; i < image.size_bytes(); i += 4) maker.add(image.data() + i, 1);
    return maker.make();
}

/// The entries of a picture, row by row.
std::vector<std::uint8_t> entries_of(const Image& image, Palette& palette) {
    std::vector<std::uint8_t> entries(image.size_bytes() / 4);
    for (int y = 0; y < image.height(); ++y)
        palette.map(image.pixel(0, y), image.width(), 0, y,
                    &entries[static_cast<std::size_t>(y * image.width())]);
    return entries;
}

TEST(Palette, ShowsAGroundThatChangesSlowlyWithoutSteps) {
    const Image image = ground_and_colors();
    Palette palette = palette_of(image);
    const auto entries = entries_of(image, palette);
    double worst = 0.0;  // difference of the mean of 8x8 pixels, in levels
    for (int y = 0; y < kSide; y += 8) {
        for (const std::size_t channel : {0U, 1U, 2U}) {
            double sum = 0.0;
            for (int i = 0; i < 64; ++i) {
                const int row = y + i / 8;
                const auto entry = entries[static_cast<std::size_t>(row * image.width() + i % 8)];
                sum += palette.bgra(entry)[2 - channel] - image.pixel(i % 8, row)[channel];
            }
            // The ends are beyond the outermost entries.
            if (y >= 16 && y < kSide - 16) worst = std::max(worst, std::abs(sum / 64));
        }
    }
    RecordProperty("worst", std::to_string(worst));
    EXPECT_LT(worst, 1.3);  // measured 1.13; 2.3 with the nearest entries alone
}

TEST(Palette, HasTheSameEntryForTheSameColourAtTheSamePlace) {
    const Image image = ground_and_colors();
    Palette palette = palette_of(image);
    const auto entries = entries_of(image, palette);
    std::vector<std::uint8_t> part(5);
    palette.map(image.pixel(11, 100), 5, 11, 100, part.data());
    EXPECT_TRUE(
        std::equal(part.begin(), part.end(), &entries[static_cast<std::size_t>(100 * image.width() + 11)]));
}

TEST(Palette, KeepsFewColoursExactly) {
    Image image(16, 15);
    for (int i = 0; i < 240; ++i) {
        image.pixel(i % 16, i / 16)[0] = static_cast<std::uint8_t>(i);
        image.pixel(i % 16, i / 16)[3] = 255;
    }
    Palette palette = palette_of(image);
    const auto entries = entries_of(image, palette);
    for (int i = 0; i < 240; ++i) EXPECT_EQ(palette.bgra(entries[static_cast<std::size_t>(i)])[2], i);
}

}  // namespace
}  // namespace corda::media
