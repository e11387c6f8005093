#include "corda/golden/compare.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>

namespace corda {
namespace {

constexpr int kChannels = 4;

/// The largest and the sum of the differences of one pixel's channels.
struct PixelDifference {
    int max = 0;
    int sum = 0;
};

PixelDifference difference_of(const std::uint8_t* a, const std::uint8_t* b) {
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

}  // namespace

bool Difference::within(const DifferenceLimits& limits) const {
    if (!same_size) return false;
    if (!limits.max && !limits.mean && !limits.share) return equal;
    return (!limits.max || max <= *limits.max) && (!limits.mean || mean <= *limits.mean) &&
           (!limits.share || share <= *limits.share);
}

Difference compare(const Image& a, const Image& b, const OnProgress& on_progress) {
    Difference result;
    if (a.width() != b.width() || a.height() != b.height()) {
        result.same_size = false;
        result.equal = false;
        return result;
    }
    std::uint64_t sum = 0;
    std::uint64_t differing = 0;
    const std::uint64_t pixels = a.size_bytes() / kChannels;
    for (int y = 0; y < a.height(); ++y) {
        report_progress(on_progress, y, a.height());
        for (std::size_t i = 0; i < a.row_bytes(); i += kChannels) {
            const PixelDifference pixel = difference_of(a.pixel(0, y) + i, b.pixel(0, y) + i);
            result.max = std::max(result.max, pixel.max);
            sum += static_cast<std::uint64_t>(pixel.sum);
            differing += pixel.max > 0 ? 1 : 0;
        }
    }
    result.equal = differing == 0;
    if (pixels == 0) return result;
    result.mean = static_cast<double>(sum) / static_cast<double>(pixels * kChannels);
    result.share = static_cast<double>(differing) / static_cast<double>(pixels);
    return result;
}

Image difference_image(const Image& a, const Image& b, const OnProgress& on_progress) {
    assert(a.width() == b.width() && a.height() == b.height());
    Image result(a.width(), a.height());
    for (std::size_t i = 0; i < a.size_bytes(); i += kChannels) {
        if (i % a.row_bytes() == 0)
            report_progress(on_progress, static_cast<std::int64_t>(i / a.row_bytes()), a.height());
        const PixelDifference pixel = difference_of(a.data() + i, b.data() + i);
        const std::uint8_t grey = dim_grey(a.data() + i);
        const std::array<std::uint8_t, kChannels> rgba =
            pixel.max > 0 ? heat(pixel.max) : std::array<std::uint8_t, kChannels>{grey, grey, grey, 255};
        std::copy(rgba.begin(), rgba.end(), result.data() + i);
    }
    return result;
}

}  // namespace corda
