#include "corda/media/read/color_patch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "support/yuv420_image.hpp"

namespace corda::media {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

void paint(Image& image, const PixelRect& rect, const Rgb& rgb) {
    for (int y = rect.y0; y < rect.y1; ++y) {
        for (int x = rect.x0; x < rect.x1; ++x) std::copy(rgb.begin(), rgb.end(), image.pixel(x, y));
    }
}

TEST(ColorPatches, OfOneColourStartInTheCorners) {
    Image image(64, 48);
    paint(image, image.rect(), {1, 2, 3});
    const auto patches = choose_patches(image);
    ASSERT_EQ(patches.size(), 5U);
    EXPECT_EQ(patches[0].x, 0);
    EXPECT_EQ(patches[0].y, 0);
    std::set<std::pair<int, int>> places;
    for (const ColorPatch& patch : patches) {
        EXPECT_EQ(patch.rgb, (Rgb{1, 2, 3}));
        EXPECT_EQ(patch.x % kPatchSide, 0);
        EXPECT_EQ(patch.y % kPatchSide, 0);
        places.emplace(patch.x, patch.y);
    }
    EXPECT_EQ(places.size(), 5U);
    EXPECT_TRUE(places.contains({48, 32}));
}

TEST(ColorPatches, PreferDifferentColours) {
    Image image(256, 48);
    const std::vector<Rgb> colors{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}};
    for (int i = 0; i < 4; ++i)
        paint(image, {64 * i, 0, 64 * (i + 1), 48}, colors[static_cast<std::size_t>(i)]);
    std::set<Rgb> chosen;
    for (const ColorPatch& patch : choose_patches(image)) chosen.insert(patch.rgb);
    EXPECT_EQ(chosen, (std::set<Rgb>{colors.begin(), colors.end()}));
}

TEST(ColorPatches, StayAwayFromOtherColours) {
    Image image(32, 32);
    paint(image, image.rect(), {50, 50, 50});
    EXPECT_EQ(choose_patches(image).size(), 4U);
    image.pixel(24, 24)[0] = 55;  // 9 pixels from the blocks above and to the left
    EXPECT_THAT(choose_patches(image), testing::SizeIs(3));
    image.pixel(23, 23)[0] = 54;  // dithered
    EXPECT_THAT(choose_patches(image), testing::SizeIs(3));
    image.pixel(23, 23)[0] = 55;  // 8 pixels from them
    EXPECT_THAT(choose_patches(image), testing::IsEmpty());
    EXPECT_THAT(choose_patches(Image(15, 100)), testing::IsEmpty());
}

TEST(ColorPatches, ComeBackFromTheConversion) {
    double worst = 0.0;
    for (const Rgb& rgb :
         std::vector<Rgb>{{0, 0, 0}, {255, 255, 255}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {200, 100, 7}}) {
        Image image(2, 2);
        paint(image, image.rect(), rgb);
        test::Yuv420Image yuv(2, 2);
        convert_to_yuv420(image, image.rect(), yuv);
        const auto back = rgb_from_ycbcr(yuv.plane(0)[0], yuv.plane(1)[0], yuv.plane(2)[0]);
        for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(back[c] - rgb[c]));
    }
    EXPECT_LE(worst, 1.6);  // the rounding to 8 bits; measured 1.14
}

TEST(ColorPatches, ToleranceGrowsWithTheRateFactor) {
    EXPECT_EQ(patch_tolerance(0), 2.0);
    EXPECT_EQ(patch_tolerance(21), 2.0);
    EXPECT_EQ(patch_tolerance(28), 4.0);
    EXPECT_NEAR(patch_tolerance(51), 39.0, 0.1);
}

}  // namespace
}  // namespace corda::media
