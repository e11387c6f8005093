#include "corda/render/exposure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "corda/render/frame_renderer.hpp"
#include "corda/render/tiles.hpp"
#include "support/draw_lists.hpp"
#include "support/image_matchers.hpp"

namespace corda::render {
namespace {

double light_of(double level) {
    const double v = level / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double level_of(double light) {
    return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055);
}

/// The mean of pictures of one pixel on a black ground.
std::vector<int> mean_of(const std::vector<Color>& pixels, const Ground& ground = {{0, 0, 0}, {0, 0, 0}}) {
    Exposure exposure(1, 1);
    Image one(1, 1);
    for (const Color& pixel : pixels) {
        const std::uint8_t bytes[] = {pixel.r, pixel.g, pixel.b, pixel.a};
        std::copy_n(bytes, 4, one.data());
        exposure.add(one, {1}, ground);
    }
    exposure.develop(ground, one);
    return {one.data(), one.data() + 4};
}

TEST(Exposure, OfEqualImagesIsThatImage) {
    for (int level = 0; level < 256; ++level) {
        const auto v = static_cast<std::uint8_t>(level);
        for (const std::size_t count : {1U, 2U, 7U, 16U, 64U})
            EXPECT_EQ(mean_of(std::vector<Color>(count, {v, v, v})),
                      (std::vector<int>{level, level, level, 255}));
    }
}

TEST(Exposure, OfEqualTransparentImagesIsThatImage) {
    for (int alpha = 0; alpha < 256; alpha += 5) {
        for (int level = 0; level <= alpha; ++level) {
            const auto v = static_cast<std::uint8_t>(level);
            const std::vector<Color> same(3, {v, v, v, static_cast<std::uint8_t>(alpha)});
            EXPECT_EQ(mean_of(same, {{0, 0, 0, 0}, {0, 0, 0, 0}}),
                      (std::vector<int>{level, level, level, alpha}));
        }
    }
}

TEST(Exposure, AveragesLinearLight) {
    EXPECT_EQ(mean_of({{0, 0, 0}, {255, 255, 255}})[0], 188);  // and not 128
    double worst = 0.0;
    for (int a = 0; a < 256; a += 3) {
        for (int b = 0; b < 256; b += 7) {
            const std::vector<Color> pixels{{static_cast<std::uint8_t>(a), 0, 0},
                                            {static_cast<std::uint8_t>(b), 0, 0},
                                            {static_cast<std::uint8_t>(b), 0, 0}};
            const double want = level_of((light_of(a) + 2.0 * light_of(b)) / 3.0);
            worst = std::max(worst, std::abs(mean_of(pixels)[0] - want));
        }
    }
    EXPECT_LT(worst, 0.53);  // measured 0.51: the half of a level, and 16 bits of light
}

TEST(Exposure, KeepsTheColourOfAPixelThatIsTransparentHalfOfTheTime) {
    // Orange over nothing for a half of the time: the same orange, and half of the alpha.
    const auto mean = mean_of({{200, 100, 0, 255}, {0, 0, 0, 0}}, {{0, 0, 0, 0}, {0, 0, 0, 0}});
    EXPECT_EQ(mean, (std::vector<int>{100, 50, 0, 128}));  // colours times alpha
}

TEST(Exposure, HasNoValueNearARoundingBoundary) {
    double nearest = 1.0;
    for (int level = 0; level < 256; ++level) {
        const double light = 65535.0 * light_of(level);
        nearest = std::min(nearest, std::abs(light - std::floor(light) - 0.5));
        const double end = 65535.0 * light_of(level + 0.5);
        nearest = std::min(nearest, std::abs(end - std::round(end)));
    }
    EXPECT_GT(nearest, 1e-6);  // measured 0.0003; libraries differ by 1e-11
}

TEST(Exposure, AddsTheGroundOfTilesThatAreNotTouched) {
    constexpr int kWidth = 200;
    constexpr int kHeight = 150;
    for (const int alpha : {255, 100}) {
        const Ground ground{{10, 20, 30}, {90, 20, 0, static_cast<std::uint8_t>(alpha)}};
        std::vector<view::DrawList> lists;
        Exposure exposure(kWidth, kHeight);
        for (std::uint32_t seed = 1; seed <= 5; ++seed) {
            view::DrawList list = test::random_draw_list(seed, kWidth, kHeight, 2, 1);
            list.ground = ground;
            lists.push_back(list);
        }
        view::DrawList bare = lists.front();
        bare.clear();
        const Image whole = render_reference(lists, bare);
        EXPECT_FALSE(whole == render_reference(bare));
        // The mean of one list several times is that list's picture.
        const std::vector<view::DrawList> same(6, lists.front());
        EXPECT_TRUE(test::equal_images(render_reference(same, bare), render_reference(lists.front())));
    }
}

}  // namespace
}  // namespace corda::render
