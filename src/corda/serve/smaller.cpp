#include "corda/serve/smaller.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace corda::serve {
namespace {

/// The pixels first .. last of a line that one pixel of a shorter line covers. In units in which a pixel of
/// the longer line is as long as the shorter line has pixels, all lengths are integers.
struct Cover {
    std::int64_t begin;
    std::int64_t end;
    std::int64_t unit;

    Cover(int i, int shorter, int longer)
        : begin(std::int64_t{i} * longer), end(begin + longer), unit(shorter) {}

    [[nodiscard]] int first() const { return static_cast<int>(begin / unit); }
    [[nodiscard]] int last() const { return static_cast<int>((end - 1) / unit); }
    [[nodiscard]] std::uint64_t weight(int k) const {
        return static_cast<std::uint64_t>(std::min(end, (k + 1) * unit) - std::max(begin, k * unit));
    }
};

}  // namespace

Image made_smaller(const Image& image, int width_px, int height_px) {
    Image small(width_px, height_px);
    const auto rounded = [](std::uint64_t sum, std::uint64_t weight) {
        return static_cast<std::uint8_t>(weight == 0 ? 0 : (sum + weight / 2) / weight);
    };
    const auto area = static_cast<std::uint64_t>(image.width()) * static_cast<std::uint64_t>(image.height());
    for (int y = 0; y < height_px; ++y) {
        const Cover rows(y, height_px, image.height());
        for (int x = 0; x < width_px; ++x) {
            const Cover columns(x, width_px, image.width());
            std::array<std::uint64_t, 4> sum{};
            for (int k = rows.first(); k <= rows.last(); ++k) {
                for (int i = columns.first(); i <= columns.last(); ++i) {
                    const std::uint8_t* const pixel = image.pixel(i, k);
                    const std::uint64_t alpha = rows.weight(k) * columns.weight(i) * pixel[3];
                    sum[3] += alpha;
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += alpha * pixel[c];
                }
            }
            for (std::size_t c = 0; c < 3; ++c) small.pixel(x, y)[c] = rounded(sum[c], sum[3]);
            small.pixel(x, y)[3] = rounded(sum[3], area);
        }
    }
    return small;
}

}  // namespace corda::serve
