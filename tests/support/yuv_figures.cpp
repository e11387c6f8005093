#include "support/yuv_figures.hpp"

#include <cmath>
#include <limits>

namespace corda::test {
namespace {

// ITU-R BT.709-6, item 3.2.
constexpr double kRed = 0.2126;
constexpr double kBlue = 0.0722;
constexpr double kGreen = 1.0 - kRed - kBlue;

}  // namespace

std::array<double, 3> rgb_at(const Yuv420Image& picture, int x, int y) {
    const auto sample = [&](int plane, int px, int py) {
        return static_cast<double>(picture.plane(plane)[py * picture.plane_width(plane) + px]);
    };
    return media::rgb_from_ycbcr(sample(0, x, y), sample(1, x / 2, y / 2), sample(2, x / 2, y / 2));
}

double luma_psnr_db(const Yuv420Image& decoded, const Image& rendered) {
    double squares = 0.0;
    for (int y = 0; y < rendered.height(); ++y) {
        for (int x = 0; x < rendered.width(); ++x) {
            const std::uint8_t* rgb = rendered.pixel(x, y);
            const double luma = 16.0 + 219.0 * (kRed * rgb[0] + kGreen * rgb[1] + kBlue * rgb[2]) / 255.0;
            const double difference = std::round(luma) - decoded.plane(0)[y * decoded.width() + x];
            squares += difference * difference;
        }
    }
    if (squares == 0.0) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(255.0 * 255.0 * rendered.width() * rendered.height() / squares);
}

}  // namespace corda::test
