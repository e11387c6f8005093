#include "corda/render/vector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace corda::render {
namespace {

/// Distance within which two ends are one point: points are rounded to 1/1024 px, directions to a float.
constexpr double kSamePointPx = 0.005;

bool is_same(const view::PixelPoint& a, const view::PixelPoint& b) {
    return std::abs(a.x - b.x) < kSamePointPx && std::abs(a.y - b.y) < kSamePointPx;
}

/// Appends the segment of a capsule to the stroke with the same width, colour and caps as `look`.
void append(std::vector<Stroke>& strokes, const view::Capsule& capsule, const Stroke& look) {
    if (look.width_px <= 0.0) return;
    const view::PixelPoint from{capsule.ax, capsule.ay};
    const view::PixelPoint to{from.x + static_cast<double>(capsule.ux) * capsule.length,
                              from.y + static_cast<double>(capsule.uy) * capsule.length};
    auto stroke = std::ranges::find_if(strokes, [&](const Stroke& other) {
        return other.width_px == look.width_px && other.color == look.color &&
               other.is_blunt == look.is_blunt;
    });
    if (stroke == strokes.end()) stroke = strokes.insert(stroke, look);
    const bool is_dot = capsule.length == 0.0F;
    const bool continues = !stroke->lines.empty() && is_same(stroke->lines.back().back(), from) && !is_dot;
    if (continues)
        stroke->lines.back().push_back(to);
    else
        stroke->lines.push_back({from, to});
}

}  // namespace

view::DrawList in_even_layers(const view::DrawList& list) {
    view::DrawList even = list;
    even.layers.clear();
    even.capsules.clear();
    for (const view::Layer& layer : list.layers) {
        const auto first = list.capsules.begin() + static_cast<std::ptrdiff_t>(layer.first_capsule);
        const auto end = first + static_cast<std::ptrdiff_t>(layer.capsule_count);
        const auto is_full = [](const view::Capsule& capsule) { return capsule.strength == 255.0F; };
        const int steps = std::all_of(first, end, is_full) ? 1 : 12;
        for (int step = 0; step < steps; ++step) {
            const double part = layer.color.a / 255.0 / steps;
            Color color = layer.color;
            color.a = static_cast<std::uint8_t>(std::lround(255.0 * part / (1.0 - part * step)));
            even.add_layer(color, layer.is_tinted);
            std::copy_if(first, end, std::back_inserter(even.capsules), [&](const view::Capsule& capsule) {
                return static_cast<double>(capsule.strength) * steps >= 255.0 * (step + 0.5);
            });
            even.layers.back().capsule_count = even.capsules.size() - even.layers.back().first_capsule;
        }
    }
    return even;
}

LayerStrokes strokes_of(const view::DrawList& list, const view::Layer& layer) {
    LayerStrokes strokes;
    std::vector<Stroke> blunt;
    std::vector<Stroke> dots;
    for (std::size_t i = layer.first_capsule; i < layer.first_capsule + layer.capsule_count; ++i) {
        const view::Capsule& capsule = list.capsules[i];
        append(strokes.halos, capsule, {.width_px = 2.0 * static_cast<double>(capsule.halo_radius)});
        Stroke look{.width_px = 2.0 * static_cast<double>(capsule.radius), .color = layer.color};
        look.color.a = 255;
        if (layer.is_tinted) look.color = {capsule.tint.r, capsule.tint.g, capsule.tint.b};
        const bool is_dot = capsule.length == 0.0F;
        append(layer.is_tinted && is_dot ? dots : strokes.lines, capsule, look);
        look.is_blunt = true;
        if (layer.is_tinted && !is_dot) append(blunt, capsule, look);
    }
    strokes.lines.insert(strokes.lines.end(), blunt.begin(), blunt.end());
    strokes.lines.insert(strokes.lines.end(), dots.begin(), dots.end());
    return strokes;
}

std::vector<view::Stamp> boxes_of(const view::DrawList& list) {
    std::vector<view::Stamp> boxes;
    for (const view::Stamp& stamp : list.stamps) {
        if (stamp.first_coverage != view::Stamp::kSolid) continue;
        if (!boxes.empty() && stamp.color.a == 255) {
            PixelRect& last = boxes.back().box;
            if (last.x1 == stamp.box.x0 && last.y0 == stamp.box.y0 && last.y1 == stamp.box.y1) ++last.x1;
        }
        boxes.push_back(stamp);
    }
    return boxes;
}

}  // namespace corda::render
