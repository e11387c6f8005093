#include <algorithm>
#include <cmath>
#include <cstdint>

#include "corda/view/scene_view.hpp"

namespace corda::view {
namespace {

constexpr double kYoungAlpha = 0.8;      // of the body's
constexpr double kOldWidth = 0.4;        // of the young end's
constexpr double kShades = 64.0;         // from the old end to the young one, at least
constexpr double kMaxDeviationPx = 0.1;  // of a polygon from the curve
constexpr double kShortestPiecePx = 0.5;

Vec2 vector(PixelPoint point) {
    return {point.x, point.y};
}

double length(Vec2 way) {
    return sim::length(way.x, way.y);
}

}  // namespace

void add_trail(std::span<const FadingPoint> points, double radius_px, Color color, DrawList& list,
               double max_pieces) {
    color.a = static_cast<std::uint8_t>(std::lround(kYoungAlpha * color.a));
    list.add_layer(color);
    FadingPoint from = points.empty() ? FadingPoint{} : points.front();
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        // A Bezier curve whose arms are no longer than its chord, so that a peak of speed makes no loop.
        const Vec2 a = vector(points[i].at);
        const Vec2 d = vector(points[i + 1].at);
        const double step = points[i + 1].left - points[i].left;
        const auto arm = [&](PixelPoint slope) {
            const Vec2 way = step / 3.0 * vector(slope);
            return std::min(1.0, length(d - a) / std::max(length(way), 1e-300)) * way;
        };
        const Vec2 b = a + arm(points[i].slope);
        const Vec2 c = d - arm(points[i + 1].slope);
        // A polygon of n pieces deviates by at most 1/8 of the second derivative over n^2.
        const double bend_px = std::max(length(a - 2.0 * b + c), length(b - 2.0 * c + d));
        const double needed = std::max(std::sqrt(0.75 * bend_px / kMaxDeviationPx), kShades * step);
        const int pieces = static_cast<int>(std::ceil(std::clamp(needed, 1.0, max_pieces)));
        for (int k = 1; k <= pieces; ++k) {
            const double t = 1.0 * k / pieces;
            const double u = 1.0 - t;
            const Vec2 at = u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d;
            const FadingPoint to{{at.x, at.y}, points[i].left + t * step, {}};
            const bool is_end = k == pieces && i + 2 == points.size();
            if (!is_end && length(at - vector(from.at)) < kShortestPiecePx) continue;
            const double left = 0.5 * (from.left + to.left);
            const double width = kOldWidth + (1.0 - kOldWidth) * left;
            list.add_capsule(from.at, to.at, radius_px * width, 0.0, {}, left);
            from = to;
        }
    }
}

}  // namespace corda::view
