#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/golden/perceived.hpp"

namespace corda {
namespace {

constexpr int kTaps = kMinSsimSidePx;
/// Means of a, b, aa, bb and ab.
constexpr std::size_t kMoments = 5;

std::array<double, kTaps> gaussian() {
    constexpr double kDeviation = 1.5;
    constexpr int kMiddle = kTaps / 2;
    std::array<double, kTaps> weights{};
    double sum = 0.0;
    for (int i = 0; i < kTaps; ++i) {
        const double x = (i - kMiddle) / kDeviation;
        weights[static_cast<std::size_t>(i)] = std::exp(-0.5 * x * x);
        sum += weights[static_cast<std::size_t>(i)];
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

void read_luma(const Image& image, int y, std::vector<double>& luma) {
    for (int x = 0; x < image.width(); ++x) {
        const std::uint8_t* const rgba = image.pixel(x, y);
        luma[static_cast<std::size_t>(x)] =
            (0.299 * rgba[0] + 0.587 * rgba[1] + 0.114 * rgba[2]) * rgba[3] / 255.0;
    }
}

/// The last rows, filtered along them.
class Rows {
  public:
    explicit Rows(int width)
        : width_(static_cast<std::size_t>(width)), out_(width_ - kTaps + 1), a_(width_), b_(width_) {
        for (auto& row : rows_)
            for (auto& moment : row) moment.resize(out_);
    }

    void add(const Image& a, const Image& b, int y) {
        read_luma(a, y, a_);
        read_luma(b, y, b_);
        auto& row = rows_[static_cast<std::size_t>(y % kTaps)];
        for (auto& moment : row) std::fill(moment.begin(), moment.end(), 0.0);
        for (std::size_t k = 0; k < kTaps; ++k) {
            const double weight = weights_[k];
            for (std::size_t x = 0; x < out_; ++x) {
                const double u = a_[x + k];
                const double v = b_[x + k];
                row[0][x] += weight * u;
                row[1][x] += weight * v;
                row[2][x] += weight * (u * u);
                row[3][x] += weight * (v * v);
                row[4][x] += weight * (u * v);
            }
        }
    }

    /// Sum over the windows that end at row `y`.
    [[nodiscard]] double sum(int y) const {
        double sum = 0.0;
        for (std::size_t x = 0; x < out_; ++x) {
            std::array<double, kMoments> mean{};
            for (int k = 0; k < kTaps; ++k) {
                const auto& row = rows_[static_cast<std::size_t>((y + 1 + k) % kTaps)];
                for (std::size_t m = 0; m < kMoments; ++m)
                    mean[m] += weights_[static_cast<std::size_t>(k)] * row[m][x];
            }
            sum += structural_similarity(mean[0], mean[1], mean[2] - mean[0] * mean[0],
                                         mean[3] - mean[1] * mean[1], mean[4] - mean[0] * mean[1]);
        }
        return sum;
    }

    [[nodiscard]] std::size_t windows() const { return out_; }

  private:
    std::size_t width_;
    std::size_t out_;  ///< windows in a row
    std::array<double, kTaps> weights_ = gaussian();
    std::vector<double> a_;
    std::vector<double> b_;
    std::array<std::array<std::vector<double>, kMoments>, kTaps> rows_;
};

}  // namespace

double ssim(const Image& a, const Image& b) {
    if (a.rect() != b.rect()) throw Error(ExitCode::kUsage, "SSIM is of two pictures of one size");
    if (std::min(a.width(), a.height()) < kMinSsimSidePx) {
        throw Error(ExitCode::kUsage,
                    "SSIM is of pictures of at least 11x11 pixels; compare smaller ones by --max or --mean");
    }
    Rows rows(a.width());
    double sum = 0.0;
    for (int y = 0; y < a.height(); ++y) {
        check_cancelled();
        rows.add(a, b, y);
        if (y + 1 >= kTaps) sum += rows.sum(y);
    }
    return sum / (static_cast<double>(rows.windows()) * (a.height() - kTaps + 1));
}

}  // namespace corda
