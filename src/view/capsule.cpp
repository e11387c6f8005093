#include "corda/view/capsule.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

constexpr double kSnap = 1024.0;  // steps per pixel: 16384 px * 1024 still fits into a float's 24 bits

constexpr double kFarthestPx = 1e30;  // far from overflow in every product below
constexpr double kCutSlack = 1.0;     // px; more than rounding takes within the coordinates of a sane scene

double snapped(double x_px) {
    return std::round(x_px * kSnap) / kSnap;
}

/// Cuts the range [t0, t1] of a + t (b - a) to low <= coordinate <= high (Liang-Barsky). Returns false if the
/// range becomes empty.
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

std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width, int height,
                                    double halo_px) {
    if (std::isnan(a.x) || std::isnan(a.y) || std::isnan(b.x) || std::isnan(b.y)) return std::nullopt;
    for (double* coordinate : {&a.x, &a.y, &b.x, &b.y})
        *coordinate = std::clamp(*coordinate, -kFarthestPx, kFarthestPx);
    // Twice what the capsule extends around its segment, so that the cap at a cut stays outside the frame.
    const double margin = 2.0 * (radius_px + halo_px + static_cast<double>(kEdgeMargin));
    double t0 = 0.0;
    double t1 = 1.0;
    if (!cut(a.x, b.x, -margin, width + margin, t0, t1)) return std::nullopt;
    if (!cut(a.y, b.y, -margin, height + margin, t0, t1)) return std::nullopt;
    // From far away, rounding can miss the cut by more than a float holds.
    const auto at = [&](double t) {
        return PixelPoint{
            snapped(std::clamp(a.x + t * (b.x - a.x), -margin - kCutSlack, width + margin + kCutSlack)),
            snapped(std::clamp(a.y + t * (b.y - a.y), -margin - kCutSlack, height + margin + kCutSlack))};
    };
    const PixelPoint from = at(t0);
    const PixelPoint to = at(t1);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    Capsule capsule;
    capsule.ax = static_cast<float>(from.x);
    capsule.ay = static_cast<float>(from.y);
    capsule.radius = static_cast<float>(radius_px);
    if (halo_px > 0.0) capsule.halo_radius = static_cast<float>(radius_px + halo_px);
    if (length > 0.0) {
        capsule.ux = static_cast<float>(dx / length);
        capsule.uy = static_cast<float>(dy / length);
        capsule.length = static_cast<float>(length);
    }
    return capsule;
}

Surroundings surroundings(const Capsule& capsule, float extent) {
    const float bx = capsule.ax + capsule.ux * capsule.length;
    const float by = capsule.ay + capsule.uy * capsule.length;
    return {std::min(capsule.ax, bx) - extent, std::min(capsule.ay, by) - extent,
            std::max(capsule.ax, bx) + extent, std::max(capsule.ay, by) + extent};
}

PixelRect capsule_bounds(const Capsule& capsule, int width, int height) {
    const auto [x0, y0, x1, y1] =
        surroundings(capsule, std::max(capsule.radius, capsule.halo_radius) + kEdgeMargin);
    const PixelRect box{static_cast<int>(std::floor(x0)), static_cast<int>(std::floor(y0)),
                        static_cast<int>(std::ceil(x1)), static_cast<int>(std::ceil(y1))};
    return box.intersected({0, 0, width, height});
}

}  // namespace corda::view
