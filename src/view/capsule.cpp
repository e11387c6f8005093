#include "corda/view/capsule.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

constexpr double kSnap = 1024.0;  // steps a pixel: 16384 px * 1024 still fits a float's 24 bits

double snapped(double x_px) {
    return std::round(x_px * kSnap) / kSnap;
}

/// Cuts the range [t0, t1] of a + t (b - a) to low <= coordinate <= high (Liang-Barsky); false where nothing
/// is left.
bool cut(double a, double b, double low, double high, double& t0, double& t1) {
    const double d = b - a;
    if (d == 0.0) return a >= low && a <= high;
    const double at_low = (low - a) / d;
    const double at_high = (high - a) / d;
    t0 = std::max(t0, std::min(at_low, at_high));
    t1 = std::min(t1, std::max(at_low, at_high));
    return t0 <= t1;
}

}  // namespace

std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width, int height) {
    // Twice the reach: the cap of a cut end stays out of the picture too.
    const double margin = 2.0 * (radius_px + static_cast<double>(kEdgeMargin));
    double t0 = 0.0;
    double t1 = 1.0;
    if (!cut(a.x, b.x, -margin, width + margin, t0, t1)) return std::nullopt;
    if (!cut(a.y, b.y, -margin, height + margin, t0, t1)) return std::nullopt;
    const PixelPoint from{snapped(a.x + t0 * (b.x - a.x)), snapped(a.y + t0 * (b.y - a.y))};
    const PixelPoint to{snapped(a.x + t1 * (b.x - a.x)), snapped(a.y + t1 * (b.y - a.y))};
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    Capsule capsule;
    capsule.ax = static_cast<float>(from.x);
    capsule.ay = static_cast<float>(from.y);
    capsule.radius = static_cast<float>(radius_px);
    if (length > 0.0) {
        capsule.ux = static_cast<float>(dx / length);
        capsule.uy = static_cast<float>(dy / length);
        capsule.length = static_cast<float>(length);
    }
    return capsule;
}

PixelRect capsule_bounds(const Capsule& capsule, int width, int height) {
    const float bx = capsule.ax + capsule.ux * capsule.length;
    const float by = capsule.ay + capsule.uy * capsule.length;
    const float reach = capsule.radius + kEdgeMargin;
    const PixelRect box{static_cast<int>(std::floor(std::min(capsule.ax, bx) - reach)),
                        static_cast<int>(std::floor(std::min(capsule.ay, by) - reach)),
                        static_cast<int>(std::ceil(std::max(capsule.ax, bx) + reach)),
                        static_cast<int>(std::ceil(std::max(capsule.ay, by) + reach))};
    return box.intersected({0, 0, width, height});
}

}  // namespace corda::view
