// FLIP and SSIM against values of other implementations.
#include "corda/golden/perceived.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/cancel.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

Image filled(int width, int height, int r, int g, int b, int a = 255) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::uint8_t* const rgba = image.pixel(x, y);
            rgba[0] = static_cast<std::uint8_t>(r);
            rgba[1] = static_cast<std::uint8_t>(g);
            rgba[2] = static_cast<std::uint8_t>(b);
            rgba[3] = static_cast<std::uint8_t>(a);
        }
    }
    return image;
}

/// Random colours, moved by `shift` to the left.
Image pattern(int shift, int width = 60, int height = 40) {
    Image image = filled(width, height, 0, 0, 0);
    for (int y = 0; y < height; ++y) {
        for (int column = 0; column < width; ++column) {
            const int x = column + shift;
            image.pixel(column, y)[0] = static_cast<std::uint8_t>((x * 7 + y * 3) % 256);
            image.pixel(column, y)[1] = static_cast<std::uint8_t>((x * x + 5 * y) % 256);
            image.pixel(column, y)[2] = static_cast<std::uint8_t>((11 * x * y) % 256);
        }
    }
    return image;
}

/// A rectangle on a dark ground.
Image box(int left) {
    Image image = filled(60, 40, 15, 21, 34);
    for (int y = 10; y < 20; ++y) {
        for (int x = left; x < left + 12; ++x) {
            image.pixel(x, y)[0] = 240;
            image.pixel(x, y)[1] = 150;
            image.pixel(x, y)[2] = 40;
        }
    }
    return image;
}

// The expected values of the next two tests are from the authors' program (NVIDIA's flip.py of 2021,
// numpy 1.24, OpenCV 4.6), in single precision. flip() differs by 7.4e-6 for grey, 3.6e-6 for black and
// white, and less than 1e-7 for pictures with edges.

TEST(Flip, OfUniformPicturesIsThatOfTheirColors) {
    const Image black = filled(8, 8, 0, 0, 0);
    EXPECT_NEAR(flip(black, filled(8, 8, 255, 255, 255)), 0.96738285, 5e-6);
    EXPECT_NEAR(flip(filled(8, 8, 0, 255, 0), filled(8, 8, 0, 0, 255)), 1.0,
                1e-6);  // the maximum in the paper
    EXPECT_NEAR(flip(filled(8, 8, 255, 0, 0), filled(8, 8, 0, 255, 0)), 0.98666322, 5e-6);
    EXPECT_NEAR(flip(filled(8, 8, 100, 100, 100), filled(8, 8, 101, 101, 101)), 0.03078431, 1e-5);
}

TEST(Flip, OfPicturesWithEdgesIsThatOfTheAuthorsProgram) {
    EXPECT_NEAR(flip(pattern(0), pattern(1)), 0.36631644, 1e-6);
    EXPECT_NEAR(flip(box(20), box(21)), 0.03757543, 1e-6);
    EXPECT_NEAR(flip(box(20), box(21), 1, 30.0), 0.02736959, 1e-6);
}

TEST(Flip, IsSymmetricAndZeroOnlyForEqualPictures) {
    EXPECT_EQ(flip(pattern(0), pattern(0)), 0.0);
    Image other = pattern(0);
    other.pixel(59, 39)[1] ^= 1;
    EXPECT_GT(flip(pattern(0), other), 0.0);
    EXPECT_LT(flip(pattern(0), other), 1e-3);
    EXPECT_EQ(flip(pattern(0), pattern(1)), flip(pattern(1), pattern(0)));
    EXPECT_EQ(flip(Image(), Image()), 0.0);
}

TEST(Flip, DoesNotDependOnThreads) {
    const Image a = pattern(0, 90, 300);
    const Image b = pattern(1, 90, 300);
    EXPECT_EQ(flip(a, b, 1), flip(a, b, 3));
}

TEST(Flip, SeesWhatIsBehindTransparentPictures) {
    // Fully transparent pixels have no colour; a black veil is visible on white only.
    EXPECT_EQ(flip(filled(9, 9, 255, 0, 0, 0), filled(9, 9, 0, 0, 255, 0)), 0.0);
    EXPECT_NEAR(flip(filled(9, 9, 0, 0, 0, 0), filled(9, 9, 0, 0, 0, 255)), 0.96738285, 1e-5);
}

TEST(Flip, RefusesOtherSizesAndStops) {
    EXPECT_EQ(test::code_of([] { static_cast<void>(flip(box(1), pattern(0, 60, 41))); }), ExitCode::kUsage);
    const CancelScope stop = test::cancel_after(0);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(flip(box(1), box(2), 2)); }), ExitCode::kInterrupted);
}

// skimage.metrics.structural_similarity (0.19.3) of the luma, with gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False, data_range=255.
TEST(Ssim, IsThatOfScikitImage) {
    EXPECT_NEAR(ssim(pattern(0), pattern(1)), -0.0037166323790192345, 1e-9);
    EXPECT_NEAR(ssim(box(20), box(21)), 0.9213370506401926, 1e-9);
}

TEST(Ssim, OfUniformPicturesIsThatOfTheirMeans) {
    // (2 * 100 * 150 + c1) / (100^2 + 150^2 + c1), c1 = 2.55^2
    EXPECT_NEAR(ssim(filled(11, 11, 100, 100, 100), filled(11, 11, 150, 150, 150)), 30006.5025 / 32506.5025,
                1e-9);
    EXPECT_NEAR(ssim(pattern(0), pattern(0)), 1.0, 1e-12);
}

TEST(Ssim, RefusesSmallPicturesAndOtherSizes) {
    EXPECT_EQ(test::code_of([] { static_cast<void>(ssim(pattern(0, 10, 40), pattern(0, 10, 40))); }),
              ExitCode::kUsage);
    EXPECT_EQ(test::code_of([] { static_cast<void>(ssim(box(1), pattern(0, 60, 41))); }), ExitCode::kUsage);
    const CancelScope stop = test::cancel_after(20);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(ssim(box(1), box(1))); }), ExitCode::kInterrupted);
}

}  // namespace
}  // namespace corda
