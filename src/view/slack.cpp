#include "corda/view/slack.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

/// An arc of a few pixels needs few steps.
int step_count(double length_px) {
    constexpr double kPixelsPerStep = 5.0;
    constexpr int kMaxPairs = (Arc::kMaxPoints - 1) / 2;
    return 2 * std::clamp(static_cast<int>(std::min(length_px / (2.0 * kPixelsPerStep), 1e6)), 3, kMaxPairs);
}

}  // namespace

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
