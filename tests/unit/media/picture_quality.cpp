#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <regex>

#include "corda/media/picture_quality.hpp"
#include "support/command.hpp"

namespace corda::media {
namespace {

constexpr int kColumns = 66;  // not a multiple of 4
constexpr int kRows = 50;

/// A picture whose luma at (x, y) is `luma(x, y)`.
template <typename Luma>
Yuv420Image picture(Luma luma) {
    Yuv420Image image(kColumns, kRows);
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kColumns; ++x)
            image.plane(0)[y * kColumns + x] = static_cast<std::uint8_t>(luma(x, y));
    }
    return image;
}

std::string raw_luma(const Yuv420Image& image) {
    return {reinterpret_cast<const char*>(image.plane(0)), std::size_t{kColumns} * kRows};
}

/// What FFmpeg's filter prints after `key` for two grey pictures.
double by_ffmpeg(const std::string& filter, const std::string& key, const Yuv420Image& a,
                 const Yuv420Image& b) {
    const test::ScratchFolder folder;
    const std::string input = " -f rawvideo -pix_fmt gray -s 66x50 -i ";
    const auto result =
        test::run_shell("ffmpeg -hide_banner" + input + folder.write("a", raw_luma(a)) + input +
                        folder.write("b", raw_luma(b)) + " -lavfi " + filter + " -f null -");
    std::smatch match;
    if (!std::regex_search(result.err, match, std::regex(key + ":([-0-9.]+)"))) {
        ADD_FAILURE() << result.err;
        return std::nan("");
    }
    return std::stod(match[1]);
}

TEST(PictureQuality, EqualPicturesHavePerfectFigures) {
    const Yuv420Image a = picture([](int x, int y) { return (7 * x + 13 * y) % 256; });
    EXPECT_EQ(luma_mean_square(a, a), 0.0);
    EXPECT_TRUE(std::isinf(psnr_db(luma_mean_square(a, a))));
    EXPECT_DOUBLE_EQ(luma_ssim(a, a), 1.0);
}

TEST(PictureQuality, FlatPicturesGiveTheClosedForm) {
    const Yuv420Image a = picture([](int, int) { return 100; });
    const Yuv420Image b = picture([](int, int) { return 101; });
    EXPECT_EQ(luma_mean_square(a, b), 1.0);
    EXPECT_NEAR(psnr_db(1.0), 20.0 * std::log10(255.0), 1e-12);  // 48.13 dB
    // Without structure only the luminance term is left: (2 a b + c1) / (a^2 + b^2 + c1).
    EXPECT_NEAR(luma_ssim(a, b), (20200.0 + 6.5025) / (10000.0 + 10201.0 + 6.5025), 1e-12);
}

TEST(PictureQuality, OppositePicturesHaveNegativeSimilarity) {
    const Yuv420Image a = picture([](int x, int) { return x % 2 == 0 ? 0 : 255; });
    const Yuv420Image b = picture([](int x, int) { return x % 2 == 0 ? 255 : 0; });
    EXPECT_EQ(luma_mean_square(a, b), 65025.0);
    // With equal means only the structure term is left: (c2 - 2 s) / (c2 + 2 s), s = 127.5^2 * 64 / 63, c2
    // = 58.5225.
    const double twice_variance = 2.0 * 127.5 * 127.5 * 64.0 / 63.0;
    EXPECT_NEAR(luma_ssim(a, b), (58.5225 - twice_variance) / (58.5225 + twice_variance), 1e-12);  // -0.9965
}

TEST(PictureQuality, AgreesWithFfmpeg) {
    std::mt19937 random(1);
    const Yuv420Image a =
        picture([](int x, int y) { return 128 + 100 * std::sin(0.2 * x) * std::cos(0.1 * y); });
    const Yuv420Image b = picture(
        [&](int x, int y) { return a.plane(0)[y * kColumns + x] + static_cast<int>(random() % 21) - 10; });
    // FFmpeg prints six digits and computes SSIM in 32-bit floats.
    EXPECT_NEAR(psnr_db(luma_mean_square(a, b)), by_ffmpeg("psnr", "average", a, b), 1e-5);
    EXPECT_NEAR(luma_ssim(a, b), by_ffmpeg("ssim", "All", a, b), 2e-5);
}

/// A picture of 32x16: black at the left, `level` from column 12 on.
Image step(std::uint8_t level) {
    Image image(32, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x) {
            std::fill_n(image.pixel(x, y), 3, x < 12 ? std::uint8_t{0} : level);
            image.pixel(x, y)[3] = 255;
        }
    return image;
}

TEST(EdgeQuality, IsThatOfWindowsWithAnEdge) {
    EdgeQuality same;
    same.add(step(200), step(200));
    EXPECT_EQ(same.mean_square(), 0.0);
    EXPECT_NEAR(same.ssim(), 1.0, 1e-12);

    Image changed_ground = step(200);  // where no edge is
    changed_ground.pixel(30, 3)[1] = 90;
    EdgeQuality ground;
    ground.add(step(200), changed_ground);
    EXPECT_EQ(ground.mean_square(), 0.0);

    Image changed_edge = step(200);  // by 30 levels in one of the 3 * 128 channels of the two windows
    changed_edge.pixel(11, 3)[1] = 30;
    EdgeQuality edge;
    edge.add(step(200), changed_edge);
    EXPECT_DOUBLE_EQ(edge.mean_square(), 900.0 / 384.0);
    EXPECT_LT(edge.ssim(), 1.0);
}

TEST(EdgeQuality, OfPicturesWithoutEdgesIsPerfect) {
    EdgeQuality quality;
    quality.add(step(31), step(90));
    EXPECT_EQ(quality.mean_square(), 0.0);
    EXPECT_EQ(quality.ssim(), 1.0);
}

}  // namespace
}  // namespace corda::media
