#include "corda/view/trail.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

constexpr int kSteps = 12;           // of alpha
constexpr double kYoungAlpha = 0.8;  // of the body's
constexpr double kOldWidth = 0.4;    // of the young end's
constexpr int kPieces = 4;           // that a step from one point to the next is drawn as

/// A curve through the points of a path as a finer one: cubics that have at each point the slope of the
/// parabola through it and its neighbours.
std::vector<FadingPoint> smooth(std::span<const FadingPoint> path) {
    const auto chord = [&](std::size_t i) {  // from point i
        const double step = path[i + 1].left - path[i].left;
        return PixelPoint{(path[i + 1].at.x - path[i].at.x) / step, (path[i + 1].at.y - path[i].at.y) / step};
    };
    const auto slope = [&](std::size_t i) {
        if (i == 0) return chord(i);
        if (i + 1 == path.size()) return chord(i - 1);
        const double share = (path[i].left - path[i - 1].left) / (path[i + 1].left - path[i - 1].left);
        const PixelPoint a = chord(i - 1);
        const PixelPoint b = chord(i);
        return PixelPoint{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
    };
    std::vector<FadingPoint> fine;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const FadingPoint& a = path[i];
        const FadingPoint& b = path[i + 1];
        const double step = b.left - a.left;
        const PixelPoint va = slope(i);
        const PixelPoint vb = slope(i + 1);
        for (int k = 0; k < kPieces; ++k) {
            const double t = 1.0 * k / kPieces;
            const auto at = [&](double pa, double pb, double sa, double sb) {
                const double u = 1.0 - t;
                return u * u * (1.0 + 2.0 * t) * pa + t * t * (3.0 - 2.0 * t) * pb +
                       step * t * u * (u * sa - t * sb);
            };
            fine.push_back(
                {{at(a.at.x, b.at.x, va.x, vb.x), at(a.at.y, b.at.y, va.y, vb.y)}, a.left + t * step});
        }
    }
    if (!path.empty()) fine.push_back(path.back());
    return fine;
}

/// The alpha with which a layer is painted over one of alpha `below` to give `wanted`.
double alpha_over(double below, double wanted) {
    return (wanted - below) / (1.0 - below);
}

}  // namespace

std::vector<std::size_t> free_ends(const System& system) {
    std::vector<std::size_t> ends;
    for (const Body& body : system.bodies) {
        const bool is_closed = body.link_count == body.particle_count;
        if (body.is_net || is_closed) continue;
        const std::size_t first = body.first_particle;
        const std::size_t last = first + body.particle_count - 1;
        if (!system.is_pinned(last))
            ends.push_back(last);
        else if (!system.is_pinned(first))
            ends.push_back(first);
    }
    return ends;
}

void add_trail(std::span<const FadingPoint> points, double radius_px, Color color, DrawList& list) {
    const std::vector<FadingPoint> path = smooth(points);
    const auto left = [&](std::size_t i) { return 0.5 * (path[i].left + path[i + 1].left); };
    for (int step = 0; step < kSteps; ++step) {
        const double young = kYoungAlpha * (color.a / 255.0);
        Color layer = color;
        layer.a = static_cast<std::uint8_t>(
            std::lround(255.0 * alpha_over(young * step / kSteps, young * (step + 1) / kSteps)));
        list.add_layer(layer);
        for (std::size_t i = 0; i + 1 < path.size(); ++i) {
            if (left(i) * kSteps < step) continue;
            list.add_capsule(path[i].at, path[i + 1].at,
                             radius_px * (kOldWidth + (1.0 - kOldWidth) * left(i)));
        }
    }
}

}  // namespace corda::view
