// The comparison of pictures, on which every golden test depends.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "corda/golden/compare.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

Image grey(int width, int height, std::uint8_t level = 100) {
    Image image(width, height);
    std::fill(image.data(), image.data() + image.size_bytes(), level);
    return image;
}

std::array<int, 4> pixel(const Image& image, int x, int y) {
    const std::uint8_t* p = image.pixel(x, y);
    return {p[0], p[1], p[2], p[3]};
}

/// A picture of 5x4 pixels in which one channel of the last differs.
Image off_by(int channel, int change) {
    Image image = grey(5, 4);
    image.pixel(4, 3)[channel] = static_cast<std::uint8_t>(100 + change);
    return image;
}

TEST(Compare, CountsAllChannelsOfAllPixels) {
    const struct {
        Image a;
        Image b;
        double max;
        double mean;
        double share;
    } cases[] = {
        {grey(5, 4), grey(5, 4), 0, 0, 0},
        {Image(), Image(), 0, 0, 0},
        {grey(5, 4), off_by(0, 1), 1, 1.0 / 80, 1.0 / 20},
        {grey(5, 4), off_by(1, -1), 1, 1.0 / 80, 1.0 / 20},
        {grey(5, 4), off_by(2, 1), 1, 1.0 / 80, 1.0 / 20},
        {grey(5, 4), off_by(3, -1), 1, 1.0 / 80, 1.0 / 20},  // alpha counts like the others
        {grey(3, 3, 0), grey(3, 3, 255), 255, 255, 1},
    };
    for (const auto& [a, b, max, mean, share] : cases) {
        const Difference result = compare(a, b);
        EXPECT_TRUE(result.same_size);
        EXPECT_EQ(result.equal, max == 0);
        EXPECT_EQ(result.max, max);
        EXPECT_EQ(result.mean, mean);
        EXPECT_EQ(result.share, share);
        EXPECT_EQ(result.within({}), max == 0);
        EXPECT_TRUE(result.within({.max = 255, .mean = 255, .share = 1}));
    }
}

Picture deep_grey(std::uint16_t level) {
    DeepImage deep(3, 2);
    std::fill(deep.pixel(0, 0), deep.pixel(0, 0) + 4 * 3 * 2, level);
    return {.image = grey(3, 2, 100), .deep = deep};
}

TEST(Compare, CountsSixteenBits) {
    const Difference result = compare(deep_grey(25700), deep_grey(25701));
    EXPECT_FALSE(result.equal);
    EXPECT_DOUBLE_EQ(result.max, 1.0 / 257.0);
    EXPECT_DOUBLE_EQ(result.mean, 1.0 / 257.0);
    EXPECT_EQ(result.share, 1.0);
    EXPECT_TRUE(result.within({.max = 0.01, .mean = {}, .share = {}}));
    EXPECT_TRUE(compare(deep_grey(25700), {.image = grey(3, 2, 100)}).equal);
    EXPECT_FALSE(compare({.image = grey(3, 2, 100)}, deep_grey(25699)).equal);
    EXPECT_TRUE(compare(deep_grey(5), deep_grey(5)).equal);
    // Bright enough to be seen.
    EXPECT_EQ(pixel(difference_image(deep_grey(25700), deep_grey(25701)), 1, 1)[0], 161);
}

TEST(Compare, IgnoresBlackPixelsOfTheMask) {
    Image b = grey(5, 4);
    b.pixel(4, 3)[0] = 250;
    b.pixel(1, 1)[1] = 103;
    Image mask = grey(5, 4, 255);
    std::fill(mask.pixel(4, 3), mask.pixel(4, 3) + 3, std::uint8_t{0});
    const Difference result = compare(grey(5, 4), b, &mask);
    EXPECT_EQ(result.max, 3);
    EXPECT_EQ(result.mean, 3.0 / 76.0);
    EXPECT_EQ(result.share, 1.0 / 19.0);
    const Image shown = difference_image(grey(5, 4), b, &mask);
    EXPECT_EQ(pixel(shown, 4, 3), pixel(shown, 0, 0));
    EXPECT_NE(pixel(shown, 1, 1), pixel(shown, 0, 0));
    const Image small = grey(4, 4, 255);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(compare(b, b, &small)); }), ExitCode::kUsage);
    const Image nothing = grey(5, 4, 0);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(compare(b, b, &nothing)); }), ExitCode::kUsage);
}

TEST(Compare, ShowsPixelsOfOnlyOnePicture) {
    const Image shown = difference_image(grey(5, 2), grey(3, 4));
    EXPECT_EQ(shown.width(), 5);
    EXPECT_EQ(shown.height(), 4);
    const std::array<int, 4> blue{0, 0, 255, 255};
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) EXPECT_EQ(pixel(shown, x, y) == blue, x >= 3 || y >= 2) << x << " " << y;
}

TEST(Compare, CanBeCancelled) {
    const Image a = grey(5, 4);
    for (const std::int64_t last : {0, 3}) {
        const auto code_of = [last](const auto& work) {
            const CancelScope scope = test::cancel_after(last);
            return test::code_of(work);
        };
        EXPECT_EQ(code_of([&] { static_cast<void>(compare(a, a)); }), ExitCode::kInterrupted);
        EXPECT_EQ(code_of([&] { static_cast<void>(difference_image(a, a)); }), ExitCode::kInterrupted);
    }
}

TEST(Compare, AnotherSizeIsNeverWithin) {
    for (const Image& other : {grey(4, 5), grey(5, 5), grey(20, 1), Image()}) {
        const Difference result = compare(grey(5, 4), other);
        EXPECT_FALSE(result.same_size);
        EXPECT_FALSE(result.equal);
        EXPECT_FALSE(result.within({}));
        EXPECT_FALSE(result.within({.max = 255, .mean = 255, .share = 1}));
    }
}

TEST(Within, HoldsAtTheBoundOfEachLimitThatIsGiven) {
    Image b = grey(10, 10);
    b.pixel(1, 1)[0] = 104;
    b.pixel(2, 1)[1] = 96;
    const Difference result = compare(grey(10, 10), b);  // max 4, mean 0.02, share 0.02
    const struct {
        DifferenceLimits limits;
        bool is_within;
    } cases[] = {
        {{.max = 4, .mean = {}, .share = {}}, true},    {{.max = 3.99, .mean = {}, .share = {}}, false},
        {{.max = {}, .mean = 0.02, .share = {}}, true}, {{.max = {}, .mean = 0.0199, .share = {}}, false},
        {{.max = {}, .mean = {}, .share = 0.02}, true}, {{.max = {}, .mean = {}, .share = 0.0199}, false},
        {{.max = 4, .mean = 1, .share = 0.02}, true},   {{.max = 4, .mean = 1, .share = 0.001}, false},
        {{.max = 0, .mean = 1, .share = 1}, false},
    };
    for (const auto& [limits, is_within] : cases) EXPECT_EQ(result.within(limits), is_within);
}

TEST(DifferenceImage, ShowsEqualPixelsAsDimGrey) {
    const Image image = difference_image(grey(2, 2, 255), grey(2, 2, 255));
    const auto [r, g, b, a] = pixel(image, 1, 1);
    EXPECT_EQ(r, g);
    EXPECT_EQ(g, b);
    EXPECT_LE(r, 85);
    EXPECT_GT(r, 0);
    EXPECT_EQ(a, 255);
}

TEST(DifferenceImage, ShowsTheSmallestDifferenceBrightly) {
    Image b = grey(2, 2);
    b.pixel(0, 1)[3] = 101;
    const Image image = difference_image(grey(2, 2), b);
    const auto [r, g, blue, a] = pixel(image, 0, 1);
    EXPECT_GE(r, 160);
    EXPECT_LE(g, 10);
    EXPECT_EQ(blue, 0);
    EXPECT_EQ(a, 255);
}

TEST(DifferenceImage, GoesFromRedToYellow) {
    std::array<int, 4> last{};
    for (int difference = 1; difference <= 255; ++difference) {
        const auto heat =
            pixel(difference_image(grey(1, 1, 0), grey(1, 1, static_cast<std::uint8_t>(difference))), 0, 0);
        EXPECT_GE(heat[0], last[0]);
        EXPECT_GT(heat[1], last[1]);
        last = heat;
    }
    EXPECT_EQ(last, (std::array<int, 4>{255, 255, 0, 255}));
}

}  // namespace
}  // namespace corda
