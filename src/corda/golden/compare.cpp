#include "corda/golden/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"

namespace corda {
namespace {

constexpr int kChannels = 4;

/// The largest and the sum of the differences of one pixel's channels.
struct PixelDifference {
    int max = 0;
    int sum = 0;
};

/// The number of sample steps in one step of 8 bits.
template <class Sample>
constexpr int kSamplesPerUnit = sizeof(Sample) == 1 ? 1 : 257;

template <class Sample>
PixelDifference difference_of(const Sample* a, const Sample* b) {
    PixelDifference result;
    for (int c = 0; c < kChannels; ++c) {
        const int difference = std::abs(int{a[c]} - int{b[c]});
        result.max = std::max(result.max, difference);
        result.sum += difference;
    }
    return result;
}

/// A grey that is dark enough for differences to stand out: always darker than heat().
std::uint8_t dim_grey(const std::uint8_t* rgba) {
    constexpr int kDimming = 3;
    const int luma = (299 * rgba[0] + 587 * rgba[1] + 114 * rgba[2]) / 1000;
    return static_cast<std::uint8_t>(luma / kDimming);
}

/// From red for a difference of 1 to yellow for 255.
std::array<std::uint8_t, kChannels> heat(int difference) {
    constexpr int kFaintestRed = 160;
    const int red = std::min(255, kFaintestRed + difference);
    return {static_cast<std::uint8_t>(red), static_cast<std::uint8_t>(difference), 0, 255};
}

void check_mask(const PixelRect& picture, const Image& mask) {
    if (mask.rect() == picture) return;
    throw Error(ExitCode::kUsage,
                Problem{{},
                        fmt::format("the mask has {}x{} pixels, the pictures have {}x{}", mask.width(),
                                    mask.height(), picture.width(), picture.height()),
                        "give a mask of their size"});
}

/// Black in the mask.
bool is_left_out(const Image* mask, int x, int y) {
    if (mask == nullptr) return false;
    const std::uint8_t* const rgba = mask->pixel(x, y);
    return rgba[0] == 0 && rgba[1] == 0 && rgba[2] == 0;
}

template <class Sample>
Difference compare_samples(const BasicImage<Sample>& a, const BasicImage<Sample>& b, const Image* mask) {
    Difference result;
    if (a.rect() != b.rect()) {
        result.same_size = false;
        result.equal = false;
        return result;
    }
    if (mask != nullptr) check_mask(a.rect(), *mask);
    int max = 0;
    std::uint64_t sum = 0;
    std::uint64_t differing = 0;
    std::uint64_t pixels = 0;
    for (int y = 0; y < a.height(); ++y) {
        check_cancelled();
        // Most rows of most pictures are equal, and this finds it a hundred times faster.
        if (mask == nullptr && std::memcmp(a.pixel(0, y), b.pixel(0, y), a.row_bytes()) == 0) {
            pixels += static_cast<std::uint64_t>(a.width());
            continue;
        }
        for (int x = 0; x < a.width(); ++x) {
            if (is_left_out(mask, x, y)) continue;
            const PixelDifference pixel = difference_of(a.pixel(x, y), b.pixel(x, y));
            max = std::max(max, pixel.max);
            sum += static_cast<std::uint64_t>(pixel.sum);
            differing += pixel.max > 0 ? 1 : 0;
            ++pixels;
        }
    }
    result.equal = differing == 0;
    if (pixels == 0 && mask != nullptr)
        throw Error(ExitCode::kUsage, Problem{{},
                                              "the mask is black everywhere, which leaves nothing to compare",
                                              "make it white where pictures must agree"});
    if (pixels == 0) return result;
    constexpr int kUnit = kSamplesPerUnit<Sample>;
    result.max = static_cast<double>(max) / kUnit;
    result.mean = static_cast<double>(sum) / static_cast<double>(pixels * kChannels * kUnit);
    result.share = static_cast<double>(differing) / static_cast<double>(pixels);
    return result;
}

/// `shown` is `a` at 8 bits.
template <class Sample>
Image image_of_differences(const Image& shown, const BasicImage<Sample>& a, const BasicImage<Sample>& b,
                           const Image* mask) {
    constexpr std::array<std::uint8_t, kChannels> kOfOne{0, 0, 255, 255};
    constexpr int kUnit = kSamplesPerUnit<Sample>;
    if (mask != nullptr && a.rect() == b.rect()) check_mask(a.rect(), *mask);
    Image result(std::max(a.width(), b.width()), std::max(a.height(), b.height()));
    const PixelRect both = a.rect().intersected(b.rect());
    for (int y = 0; y < result.height(); ++y) {
        check_cancelled();
        for (int x = 0; x < result.width(); ++x) {
            std::array<std::uint8_t, kChannels> rgba = kOfOne;
            if (x < both.x1 && y < both.y1) {
                const bool counts = a.rect() != b.rect() || !is_left_out(mask, x, y);
                const int difference = counts ? difference_of(a.pixel(x, y), b.pixel(x, y)).max : 0;
                const std::uint8_t grey = dim_grey(shown.pixel(x, y));
                rgba = difference > 0 ? heat((difference + kUnit - 1) / kUnit)
                                      : std::array<std::uint8_t, kChannels>{grey, grey, grey, 255};
            }
            std::copy(rgba.begin(), rgba.end(), result.pixel(x, y));
        }
    }
    return result;
}

/// The picture at 16 bits; `made` keeps it if it has but 8.
const DeepImage& deep_of(const Picture& picture, DeepImage& made) {
    if (picture.deep) return *picture.deep;
    const Image& image = picture.image;
    made = DeepImage(image.width(), image.height());
    std::transform(image.data(), image.data() + image.size_bytes(), made.data(), [](std::uint8_t sample) {
        return static_cast<std::uint16_t>(sample * kSamplesPerUnit<std::uint16_t>);
    });
    return made;
}

}  // namespace

bool Difference::within(const DifferenceLimits& limits) const {
    if (!same_size) return false;
    if (!limits.max && !limits.mean && !limits.share) return equal;
    return (!limits.max || max <= *limits.max) && (!limits.mean || mean <= *limits.mean) &&
           (!limits.share || share <= *limits.share);
}

std::string figures_text(const Difference& difference) {
    return fmt::format("max {:.6g}, mean {:.6g}, share {:.6g}", difference.max, difference.mean,
                       difference.share);
}

Difference compare(const Image& a, const Image& b, const Image* mask) {
    return compare_samples(a, b, mask);
}

Difference compare(const Picture& a, const Picture& b, const Image* mask) {
    if (!a.deep && !b.deep) return compare_samples(a.image, b.image, mask);
    DeepImage of_a;
    DeepImage of_b;
    return compare_samples(deep_of(a, of_a), deep_of(b, of_b), mask);
}

Image difference_image(const Picture& a, const Picture& b, const Image* mask) {
    if (!a.deep && !b.deep) return difference_image(a.image, b.image, mask);
    DeepImage of_a;
    DeepImage of_b;
    return image_of_differences(a.image, deep_of(a, of_a), deep_of(b, of_b), mask);
}

Image difference_image(const Image& a, const Image& b, const Image* mask) {
    return image_of_differences(a, a, b, mask);
}

}  // namespace corda
