#include "corda/view/draw_list.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

constexpr double kSnap = 1024.0;  // steps per pixel: 16384 px * 1024 still fits into a float's 24 bits

constexpr double kMaxDistancePx = 1e30;  // far from overflow in every product below
constexpr double kCutSlack = 1.0;  // px; more than rounding takes within the coordinates of a sane scene

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

/// Number of steps of an arc, which grows with its length.
int step_count(double length_px) {
    constexpr double kPixelsPerStep = 5.0;
    constexpr int kMaxPairs = (Arc::kMaxPoints - 1) / 2;
    return 2 * std::clamp(static_cast<int>(std::min(length_px / (2.0 * kPixelsPerStep), 1e6)), 3, kMaxPairs);
}

}  // namespace

std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width, int height,
                                    double halo_px) {
    if (std::isnan(a.x) || std::isnan(a.y) || std::isnan(b.x) || std::isnan(b.y)) return std::nullopt;
    for (double* coordinate : {&a.x, &a.y, &b.x, &b.y})
        *coordinate = std::clamp(*coordinate, -kMaxDistancePx, kMaxDistancePx);
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

bool DrawList::has_tints() const {
    return std::ranges::any_of(layers, &Layer::is_tinted);
}

bool DrawList::shows_nothing() const {
    const auto is_outside = [this](const Capsule& capsule) {
        const Surroundings box = surroundings(capsule, capsule.radius);
        return box.x1 <= 0.0F || box.y1 <= 0.0F || box.x0 >= static_cast<float>(width) ||
               box.y0 >= static_cast<float>(height);
    };
    return std::ranges::all_of(layers, [&](const Layer& layer) {
        const Capsule* const first = capsules.data() + layer.first_capsule;
        return layer.is_note || std::all_of(first, first + layer.capsule_count, is_outside);
    });
}

void DrawList::clear() {
    capsules.clear();
    layers.clear();
    stamps.clear();
    coverage.clear();
    texts.clear();
}

void DrawList::add_layer(Color color, bool is_tinted) {
    layers.push_back({color, capsules.size(), 0, is_tinted});
}

void DrawList::add_capsule(PixelPoint a, PixelPoint b, double radius_px, double halo_px, Tint tint,
                           double opacity) {
    auto capsule = make_capsule(a, b, radius_px, width, height, halo_px);
    if (!capsule) return;
    capsule->tint = tint;
    capsule->strength = static_cast<float>(255.0 * opacity);
    capsules.push_back(*capsule);
    ++layers.back().capsule_count;
}

void DrawList::add_ring(PixelPoint center, double radius_px, double width_px) {
    constexpr int kSides = 64;
    // Of 2 pi / 64; C libraries differ in their last bits.
    constexpr double kCosine = 0.99518472667219688624;
    constexpr double kSine = 0.09801714032956060199;
    Vec2 spoke{radius_px, 0.0};
    for (int k = 0; k < kSides; ++k) {
        const Vec2 next{kCosine * spoke.x - kSine * spoke.y, kSine * spoke.x + kCosine * spoke.y};
        add_capsule({center.x + spoke.x, center.y + spoke.y}, {center.x + next.x, center.y + next.y},
                    0.5 * width_px);
        spoke = next;
    }
}

void DrawList::add_box(const PixelRect& box, Color color) {
    const PixelRect visible = box.intersected({0, 0, width, height});
    if (!visible.empty()) stamps.push_back({visible, color});
}

Arc hang_slack(PixelPoint a, PixelPoint b, double length_px, PixelPoint down) {
    const int steps = step_count(length_px);
    const double dx = (b.x - a.x) / steps;
    const double dy = (b.y - a.y) / steps;
    // 4 t (1 - t) grows by this from step k to the next.
    const auto growth = [steps](int k) { return 4.0 * (steps - 1 - 2 * k) / (1.0 * steps * steps); };
    // The length is a convex, growing function of the sag, and that of the sag alone is at most this:
    // Newton's method comes down to the root.
    double sag_px = 0.5 * length_px + std::sqrt(dx * dx + dy * dy) * steps;
    constexpr int kMaxIterations = 50;
    for (int i = 0; i < kMaxIterations; ++i) {
        double sum_px = 0.0;
        double slope = 0.0;
        for (int k = 0; k < steps; ++k) {
            const double x = dx + growth(k) * sag_px * down.x;
            const double y = dy + growth(k) * sag_px * down.y;
            const double step_px = std::sqrt(x * x + y * y);
            sum_px += step_px;
            if (step_px > 0.0) slope += growth(k) * (x * down.x + y * down.y) / step_px;
        }
        const double excess_px = sum_px - length_px;
        constexpr double kNearPx = 1e-6;
        if (excess_px < kNearPx || slope <= 0.0) break;
        sag_px = std::max(0.0, sag_px - excess_px / slope);
    }
    Arc arc;
    for (int k = 0; k <= steps; ++k) {
        const double sag = 4.0 * k * (steps - k) / (1.0 * steps * steps) * sag_px;
        arc.points[arc.count++] = {a.x + k * dx + sag * down.x, a.y + k * dy + sag * down.y};
    }
    return arc;
}

}  // namespace corda::view
