#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

#include "support/yuv420_image.hpp"

namespace corda::media {
namespace {

using test::Yuv420Image;

Image random_image(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    Image image(width, height);
    for (std::size_t i = 0; i < image.size_bytes(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(random() & 0xffU);
    return image;
}

Image filled(int width, int height, std::array<std::uint8_t, 3> rgb) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::copy(rgb.begin(), rgb.end(), image.pixel(x, y));
            image.pixel(x, y)[3] = 255;
        }
    }
    return image;
}

using Rgb = std::array<double, 3>;

double luma_of(const Rgb& p) {
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// The formula of ITU-R BT.709-6 in doubles, not rounded: Y at (x, y), Cb and Cr at its chroma sample.
std::array<double, 3> reference(const Image& image, int x, int y) {
    const auto rgb = [&](int column, int row) {
        const std::uint8_t* p = image.pixel(std::clamp(column, 0, image.width() - 1), row);
        return Rgb{p[0] / 255.0, p[1] / 255.0, p[2] / 255.0};
    };
    Rgb mean{};
    const int left = x / 2 * 2;
    const int top = y / 2 * 2;
    for (int row = 0; row < 2; ++row) {
        for (int column = -1; column <= 1; ++column) {
            const Rgb p = rgb(left + column, top + row);
            for (int c = 0; c < 3; ++c) mean[c] += p[c] * (column == 0 ? 2.0 : 1.0) / 8.0;
        }
    }
    const double y_mean = luma_of(mean);
    return {16 + 219 * luma_of(rgb(x, y)), 128 + 224 * (mean[2] - y_mean) / 1.8556,
            128 + 224 * (mean[0] - y_mean) / 1.5748};
}

TEST(Yuv420, MatchesTheFormulaInDoublePrecision) {
    // Measured: 0.501 for all three planes; rounding alone costs 0.5.
    constexpr double kBound = 0.52;
    for (const auto& [width, height] : {std::array{2, 2}, {4, 6}, {34, 18}, {258, 130}}) {
        const Image image = random_image(width, height, 7);
        Yuv420Image yuv(width, height);
        convert_to_yuv420(image, image.rect(), yuv);
        std::array<double, 3> worst{};
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto want = reference(image, x, y);
                for (int plane = 0; plane < 3; ++plane) {
                    const int column = plane == 0 ? x : x / 2;
                    const int row = plane == 0 ? y : y / 2;
                    const int got = yuv.plane(plane)[row * yuv.plane_width(plane) + column];
                    worst[plane] = std::max(worst[plane], std::abs(got - want[plane]));
                }
            }
        }
        for (const double error : worst) EXPECT_LE(error, kBound) << width << "x" << height;
        RecordProperty("worst", std::to_string(worst[0]) + " " + std::to_string(worst[1]) + " " +
                                    std::to_string(worst[2]));
    }
}

struct KnownColor {
    std::array<std::uint8_t, 3> rgb;
    std::array<int, 3> ycbcr;
};

class KnownColors : public testing::TestWithParam<KnownColor> {};

TEST_P(KnownColors, GiveTheValuesOfTheStandard) {
    const std::array<std::uint8_t, 3> rgb = GetParam().rgb;
    const std::array<int, 3> want = GetParam().ycbcr;
    const Image image = filled(34, 4, rgb);
    Yuv420Image yuv(34, 4);
    convert_to_yuv420(image, image.rect(), yuv);
    for (int plane = 0; plane < 3; ++plane) {
        const int count = yuv.plane_width(plane) * yuv.plane_height(plane);
        EXPECT_TRUE(
            std::all_of(yuv.plane(plane), yuv.plane(plane) + count, [&](int v) { return v == want[plane]; }))
            << "plane " << plane << " begins with " << int{yuv.plane(plane)[0]};
    }
}

INSTANTIATE_TEST_SUITE_P(
    Bt709, KnownColors,
    testing::Values(KnownColor{{255, 0, 0}, {63, 102, 240}}, KnownColor{{0, 255, 0}, {173, 42, 26}},
                    KnownColor{{0, 0, 255}, {32, 240, 118}}, KnownColor{{0, 0, 0}, {16, 128, 128}},
                    KnownColor{{255, 255, 255}, {235, 128, 128}},
                    KnownColor{{128, 128, 128}, {126, 128, 128}}, KnownColor{{1, 1, 1}, {17, 128, 128}}));

TEST(Yuv420, EveryGreyIsNeutral) {
    for (int grey = 0; grey < 256; ++grey) {
        const auto g = static_cast<std::uint8_t>(grey);
        const Image image = filled(2, 2, {g, g, g});
        Yuv420Image yuv(2, 2);
        convert_to_yuv420(image, image.rect(), yuv);
        EXPECT_EQ(yuv.plane(0)[0], std::lround(16 + 219 * grey / 255.0));
        EXPECT_EQ(yuv.plane(1)[0], 128);
        EXPECT_EQ(yuv.plane(2)[0], 128);
    }
}

TEST(Yuv420, DamageGivesTheBytesOfAFullConversion) {
    constexpr int kWidth = 78;
    constexpr int kHeight = 40;
    std::mt19937 random(3);
    Image image = random_image(kWidth, kHeight, 1);
    Yuv420Image partial(kWidth, kHeight);
    convert_to_yuv420(image, image.rect(), partial);
    for (int round = 0; round < 2000; ++round) {
        const int x0 = static_cast<int>(random() % kWidth);
        const int y0 = static_cast<int>(random() % kHeight);
        const PixelRect damage{x0, y0, x0 + 1 + static_cast<int>(random() % (kWidth - x0)),
                               y0 + 1 + static_cast<int>(random() % (kHeight - y0))};
        for (int y = damage.y0; y < damage.y1; ++y) {
            for (int x = damage.x0; x < damage.x1; ++x) {
                for (int c = 0; c < 4; ++c)
                    image.pixel(x, y)[c] = static_cast<std::uint8_t>(random() & 0xffU);
            }
        }
        convert_to_yuv420(image, damage, partial);
        Yuv420Image full(kWidth, kHeight);
        convert_to_yuv420(image, image.rect(), full);
        ASSERT_TRUE(partial == full) << "round " << round << " rect " << damage.x0 << " " << damage.y0 << " "
                                     << damage.x1 << " " << damage.y1;
    }
}

TEST(Yuv420, LeavesPixelsFarFromTheDamage) {
    const Image image = filled(64, 16, {255, 0, 0});
    Yuv420Image yuv(64, 16);
    convert_to_yuv420(image, {32, 8, 33, 9}, yuv);
    EXPECT_EQ(yuv.plane(0)[8 * 64 + 32], 63);
    EXPECT_EQ(yuv.plane(0)[0], 0);
    EXPECT_EQ(yuv.plane(1)[0], 0);
    const Yuv420Image before = yuv;
    convert_to_yuv420(image, {}, yuv);
    convert_to_yuv420(image, {64, 0, 70, 16}, yuv);
    EXPECT_TRUE(before == yuv);
}

}  // namespace
}  // namespace corda::media
