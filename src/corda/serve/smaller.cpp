#include "corda/serve/smaller.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace corda::serve {
namespace {

constexpr std::size_t kChannels = 4;

/// The pixels of a line that one pixel of a shorter line covers, with the share of each. In units in which a
/// pixel of the longer line is as long as the shorter line has pixels, all lengths are integers.
struct Cover {
    std::size_t first;
    std::vector<std::int32_t> weights;

    Cover(int i, int shorter, int longer) {
        const std::int64_t begin = std::int64_t{i} * longer;
        const std::int64_t end = begin + longer;
        first = static_cast<std::size_t>(begin / shorter);
        for (std::int64_t k = begin / shorter; k * shorter < end; ++k)
            weights.push_back(
                static_cast<std::int32_t>(std::min(end, (k + 1) * shorter) - std::max(begin, k * shorter)));
    }
};

/// Adds a row of pixels to `sums`: channels times alpha, and alpha, each with a weight.
void add_row(const std::uint8_t* pixels, std::int32_t weight, std::span<std::int32_t> sums) {
    for (std::size_t i = 0; i < sums.size(); i += kChannels) {
        const std::int32_t alpha = weight * pixels[i + 3];
        const std::int32_t factors[kChannels] = {pixels[i], pixels[i + 1], pixels[i + 2], 1};
        for (std::size_t c = 0; c < kChannels; ++c) sums[i + c] += alpha * factors[c];
    }
}

std::uint8_t rounded(double value) {
    return static_cast<std::uint8_t>(value + 0.5);  // NOLINT(bugprone-incorrect-roundings)
}

}  // namespace

Image made_smaller(const Image& image, int width_px, int height_px) {
    Image small(width_px, height_px);
    std::vector<Cover> columns;
    for (int x = 0; x < width_px; ++x) columns.emplace_back(x, width_px, image.width());
    const double area = static_cast<double>(image.width()) * image.height();
    static_assert(std::int64_t{255} * 255 * kMaxSidePx <= INT32_MAX);  // weights add up to a height
    std::vector<std::int32_t> row(kChannels * static_cast<std::size_t>(image.width()));
    for (int y = 0; y < height_px; ++y) {
        const Cover rows(y, height_px, image.height());
        std::ranges::fill(row, 0);
        for (std::size_t k = 0; k < rows.weights.size(); ++k)
            add_row(image.pixel(0, static_cast<int>(rows.first + k)), rows.weights[k], row);
        for (int x = 0; x < width_px; ++x) {
            const Cover& cover = columns[static_cast<std::size_t>(x)];
            const std::int32_t* covered = &row[kChannels * cover.first];
            std::array<double, kChannels> sums{};
            for (const double weight : cover.weights)
                for (double& sum : sums) sum += weight * *covered++;
            std::uint8_t* const pixel = small.pixel(x, y);
            const double alpha = sums[3];
            const double share = alpha == 0.0 ? 0.0 : 1.0 / alpha;
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = rounded(sums[c] * share);
            pixel[3] = rounded(alpha / area);
        }
    }
    return small;
}

}  // namespace corda::serve
