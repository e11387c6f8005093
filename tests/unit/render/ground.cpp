#include "corda/render/ground.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace corda::render {
namespace {

std::vector<std::uint8_t> row(const Ground& ground, int y, int width, int height) {
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width) * 4);
    write_ground_row(ground, y, width, height, rgba.data());
    return rgba;
}

TEST(Grounds, OfOneColourAreThatColour) {
    for (const Color color : {Color{0, 0, 0}, {18, 22, 31}, {255, 255, 255}}) {
        for (const int y : {0, 1, 7, 16383}) {
            for (int x = 0; x < 16; ++x) {
                const auto rgba = row({color, color}, y, 16, 16384);
                EXPECT_EQ((Color{rgba[4 * x], rgba[4 * x + 1], rgba[4 * x + 2], rgba[4 * x + 3]}), color);
            }
        }
    }
}

TEST(Grounds, HoldTheirColoursTimesTheirAlpha) {
    const auto rgba = row({{255, 128, 0, 0}, {255, 128, 0, 128}}, 15, 8, 16);
    EXPECT_EQ(rgba[3], 124);
    EXPECT_EQ(rgba[0], rgba[3]);
    EXPECT_NEAR(rgba[1], 62, 1);
    EXPECT_EQ(rgba[2], 0);
}

TEST(Grounds, ChangeEvenlyFromTopToBottom) {
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

TEST(Grounds, MixTwoLevelsInAnEighthOfTheRows) {
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
