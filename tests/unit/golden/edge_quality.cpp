#include "support/edge_quality.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace corda::test {
namespace {

TEST(PeakSignalToNoiseRatio, IsInfiniteForEqualPictures) {
    EXPECT_TRUE(std::isinf(psnr_db(0.0)));
    EXPECT_NEAR(psnr_db(1.0), 20.0 * std::log10(255.0), 1e-12);  // 48.13 dB
}

TEST(StructuralSimilarity, HasTheClosedForms) {
    // Without structure only the luminance term is left: (2 a b + c1) / (a^2 + b^2 + c1).
    EXPECT_NEAR(structural_similarity(100.0, 101.0, 0.0, 0.0, 0.0),
                (20200.0 + 6.5025) / (10000.0 + 10201.0 + 6.5025), 1e-12);
    // With equal means only the structure term is left: (c2 - 2 s) / (c2 + 2 s) for opposite pictures.
    EXPECT_NEAR(structural_similarity(127.5, 127.5, 500.0, 500.0, -500.0),
                (58.5225 - 1000.0) / (58.5225 + 1000.0), 1e-12);
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
}  // namespace corda::test
