#include "corda/media/encode/pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace corda::media {
namespace {

constexpr int kReach = AlphaBleed::kReachPx;

/// Puts a square of one colour and alpha into a picture.
PixelRect put_square(int x, int y, int side, const std::array<std::uint8_t, 4>& rgba, Image& image) {
    const PixelRect part = PixelRect{x, y, x + side, y + side}.intersected(image.rect());
    for (int row = part.y0; row < part.y1; ++row)
        for (int column = part.x0; column < part.x1; ++column)
            std::copy(rgba.begin(), rgba.end(), image.pixel(column, row));
    return part;
}

/// Whether a pixel has the colour of one of the nearest pixels that show, or its own if none is near.
bool is_filled(const Image& image, const Image& filled, int x, int y) {
    const std::uint8_t* const own = image.pixel(x, y);
    const std::uint8_t* const is = filled.pixel(x, y);
    if (is[3] != own[3]) return false;
    if (own[3] >= AlphaBleed::kMinAlpha) return std::equal(own, own + 3, is);
    int least = kReach * kReach + 1;
    bool has_color = std::equal(own, own + 3, is);
    for (int row = std::max(0, y - kReach); row <= std::min(image.height() - 1, y + kReach); ++row) {
        for (int column = std::max(0, x - kReach); column <= std::min(image.width() - 1, x + kReach);
             ++column) {
            const std::uint8_t* const other = image.pixel(column, row);
            const int square = (row - y) * (row - y) + (column - x) * (column - x);
            if (other[3] < AlphaBleed::kMinAlpha || square > least || square > kReach * kReach) continue;
            if (square < least) has_color = false;
            least = square;
            has_color = has_color || std::equal(other, other + 3, is);
        }
    }
    return has_color;
}

TEST(EdgeFills, HaveTheNearestColoursAndFollowTheDamage) {
    std::mt19937 random(20261124);  // NOLINT(cert-msc51-cpp): the same pictures on every run
    const auto below = [&](int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); };
    Image image(61, 47);
    AlphaBleed kept;
    for (int frame = 0; frame < 60; ++frame) {
        const std::array<std::uint8_t, 4> rgba{
            static_cast<std::uint8_t>(below(256)), static_cast<std::uint8_t>(below(256)),
            static_cast<std::uint8_t>(below(256)),
            static_cast<std::uint8_t>(frame % 3 == 0 ? 0 : below(2) * 127 + below(129))};
        const PixelRect part = put_square(below(64) - 3, below(50) - 3, 1 + below(12), rgba, image);
        const Image before = kept.picture();
        const PixelRect changed = kept.update(image, part);
        AlphaBleed anew;
        static_cast<void>(anew.update(image, image.rect()));
        ASSERT_EQ(kept.picture(), anew.picture()) << frame;
        for (int y = 0; y < image.height(); ++y) {
            for (int x = 0; x < image.width(); ++x) {
                ASSERT_TRUE(is_filled(image, kept.picture(), x, y)) << frame << ": " << x << ' ' << y;
                const bool is_inside = x >= changed.x0 && x < changed.x1 && y >= changed.y0 && y < changed.y1;
                if (frame == 0 || is_inside) continue;
                ASSERT_TRUE(
                    std::equal(before.pixel(x, y), before.pixel(x, y) + 4, kept.picture().pixel(x, y)));
            }
        }
    }
}

TEST(EdgeFills, SpreadColoursAsFarAsTheyReach) {
    Image image(20, 20);
    const PixelRect part = put_square(10, 10, 1, {200, 100, 50, 255}, image);
    AlphaBleed fill;
    static_cast<void>(fill.update(image, part));
    EXPECT_EQ(fill.picture().pixel(10 + kReach, 10)[0], 200);
    EXPECT_EQ(fill.picture().pixel(10, 10 - kReach)[1], 100);
    EXPECT_EQ(fill.picture().pixel(11 + kReach, 10)[0], 0);
    EXPECT_EQ(fill.picture().pixel(10 + kReach, 11)[0], 0);  // farther by the diagonal
    EXPECT_EQ(fill.picture().pixel(11, 11)[3], 0);
}

}  // namespace
}  // namespace corda::media
