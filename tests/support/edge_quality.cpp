#include "support/edge_quality.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

namespace corda::test {
namespace {

constexpr double kPeak = 255.0;
constexpr int kWindow = 8;
constexpr std::int64_t kWindowSamples = 64;

double window_ssim(const std::uint8_t* a, const std::uint8_t* b, int row_bytes) {
    std::int64_t sum_a = 0;
    std::int64_t sum_b = 0;
    std::int64_t sum_aa = 0;
    std::int64_t sum_bb = 0;
    std::int64_t sum_ab = 0;
    for (int y = 0; y < kWindow; ++y) {
        for (int x = 0; x < kWindow; ++x) {
            const std::int64_t value_a = a[y * row_bytes + x];
            const std::int64_t value_b = b[y * row_bytes + x];
            sum_a += value_a;
            sum_b += value_b;
            sum_aa += value_a * value_a;
            sum_bb += value_b * value_b;
            sum_ab += value_a * value_b;
        }
    }
    constexpr auto kCount = static_cast<double>(kWindowSamples);
    const double mean_a = static_cast<double>(sum_a) / kCount;
    const double mean_b = static_cast<double>(sum_b) / kCount;
    const auto covariance = [](std::int64_t products, std::int64_t u, std::int64_t v) {
        return static_cast<double>(kWindowSamples * products - u * v) / (kCount * (kCount - 1.0));
    };
    return structural_similarity(mean_a, mean_b, covariance(sum_aa, sum_a, sum_a),
                                 covariance(sum_bb, sum_b, sum_b), covariance(sum_ab, sum_a, sum_b));
}

/// A window of a picture of 8-bit RGBA.
struct RgbWindow {
    std::array<std::uint8_t, 3 * kWindowSamples> rgb{};
    std::array<std::uint8_t, kWindowSamples> luma{};

    RgbWindow(const Image& picture, int x0, int y0) {
        std::size_t i = 0;
        for (int y = y0; y < y0 + kWindow; ++y) {
            for (int x = x0; x < x0 + kWindow; ++x, ++i) {
                const std::uint8_t* const p = picture.pixel(x, y);
                std::copy_n(p, 3, &rgb[3 * i]);
                luma[i] = static_cast<std::uint8_t>((54 * p[0] + 183 * p[1] + 19 * p[2] + 128) >> 8);
            }
        }
    }
    [[nodiscard]] bool is_edge() const {
        constexpr int kContrast = 32;
        for (std::size_t c = 0; c < 3; ++c) {
            int least = rgb[c];
            int largest = rgb[c];
            for (std::size_t i = c; i < rgb.size(); i += 3) {
                least = std::min<int>(least, rgb[i]);
                largest = std::max<int>(largest, rgb[i]);
            }
            if (largest - least >= kContrast) return true;
        }
        return false;
    }
};

}  // namespace

double psnr_db(double mean_square) {
    if (mean_square == 0.0) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(kPeak * kPeak / mean_square);
}

void EdgeQuality::add(const Image& exact, const Image& shown) {
    assert(exact.width() == shown.width() && exact.height() == shown.height());
    for (int y = 0; y + kWindow <= exact.height(); y += kWindow) {
        for (int x = 0; x + kWindow <= exact.width(); x += kWindow) {
            const RgbWindow a(exact, x, y);
            if (!a.is_edge()) continue;
            const RgbWindow b(shown, x, y);
            for (std::size_t i = 0; i < a.rgb.size(); ++i) {
                const int difference = a.rgb[i] - b.rgb[i];
                squares_ += difference * difference;
            }
            similarities_ += window_ssim(a.luma.data(), b.luma.data(), kWindow);
            ++windows_;
        }
    }
}

double EdgeQuality::mean_square() const {
    return windows_ == 0 ? 0.0 : squares_ / static_cast<double>(3 * kWindowSamples * windows_);
}

double EdgeQuality::ssim() const {
    return windows_ == 0 ? 1.0 : similarities_ / static_cast<double>(windows_);
}

}  // namespace corda::test
