#include "corda/render/strokes.hpp"

#include <algorithm>
#include <cmath>

namespace corda::render {
namespace {

/// Ends of neighbours are that close: they were one point, rounded to 1/1024 px, and a float's direction.
constexpr double kSamePointPx = 0.005;

bool is_same(const view::PixelPoint& a, const view::PixelPoint& b) {
    return std::abs(a.x - b.x) < kSamePointPx && std::abs(a.y - b.y) < kSamePointPx;
}

void append(std::vector<Stroke>& strokes, const view::Capsule& capsule, double radius_px) {
    if (radius_px <= 0.0) return;
    const double width_px = 2.0 * radius_px;
    const view::PixelPoint from{capsule.ax, capsule.ay};
    const view::PixelPoint to{from.x + static_cast<double>(capsule.ux) * capsule.length,
                              from.y + static_cast<double>(capsule.uy) * capsule.length};
    auto stroke = std::find_if(strokes.begin(), strokes.end(),
                               [&](const Stroke& other) { return other.width_px == width_px; });
    if (stroke == strokes.end()) stroke = strokes.insert(stroke, {width_px, {}});
    const bool is_dot = capsule.length == 0.0F;
    const bool goes_on = !stroke->lines.empty() && is_same(stroke->lines.back().back(), from) && !is_dot;
    if (goes_on)
        stroke->lines.back().push_back(to);
    else
        stroke->lines.push_back({from, to});
}

}  // namespace

LayerStrokes strokes_of(const view::DrawList& list, const view::Layer& layer) {
    LayerStrokes strokes;
    for (std::size_t i = layer.first_capsule; i < layer.first_capsule + layer.capsule_count; ++i) {
        const view::Capsule& capsule = list.capsules[i];
        append(strokes.halos, capsule, capsule.halo_radius);
        append(strokes.lines, capsule, capsule.radius);
    }
    return strokes;
}

}  // namespace corda::render
