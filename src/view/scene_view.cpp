#include "corda/view/scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/view/capsule.hpp"
#include "corda/view/validate.hpp"

namespace corda::view {
namespace {

constexpr double kHeightPerRopeWidth = 216.0;
constexpr double kThinnestRopePx = 1.5;
constexpr double kNetWidthPerRopeWidth = 0.5;  // so that the cells of a cloth stay open
constexpr double kHeightPerPinnedRim = 150.0;  // rim: how far a marker extends beyond the line
constexpr double kHeightPerFreeRim = 400.0;
constexpr double kBarWidthPerRopeWidth = 0.25;
constexpr double kThinnestBarPx = 1.0;

}  // namespace

SceneView::SceneView(const System& system, const StyleDef& style,
                     const std::vector<BodyStyleDef>& body_styles, int width, int height)
    : system_(&system),
      background_(style.background),
      width_(width),
      height_(height),
      rope_width_px_(style.rope_width_px.value_or(std::max(kThinnestRopePx, height / kHeightPerRopeWidth))) {
    validate(style, body_styles);
    if (style.bars == Bars::kAll) add_bars(style, false);
    add_bodies(style, body_styles);
    if (style.bars != Bars::kNone) add_bars(style, true);
    if (style.markers == Markers::kAll) add_markers(style, false);
    if (style.markers != Markers::kNone) add_markers(style, true);
    std::erase_if(layers_, [](const ItemLayer& layer) { return layer.items.empty(); });
    if (layers_.size() > kMaxLayers) {
        throw Error(ExitCode::kInvalidScene,
                    "the scene needs " + std::to_string(layers_.size()) + " layers of colour, the limit is " +
                        std::to_string(kMaxLayers) + "; give more ropes or nets the same colour");
    }
    for (const ItemLayer& layer : layers_) {
        for (const Item& item : layer.items) clearance_px_ = std::max(clearance_px_, item.radius_px);
    }
}

SceneView::ItemLayer& SceneView::layer_of(Color color, std::size_t first_layer) {
    for (std::size_t i = first_layer; i < layers_.size(); ++i) {
        if (layers_[i].color == color) return layers_[i];
    }
    return layers_.emplace_back(ItemLayer{color, {}});
}

void SceneView::add_bodies(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles) {
    const std::size_t first_layer = layers_.size();
    std::size_t next_color = 0;
    for (std::size_t i = 0; i < system_->bodies.size(); ++i) {
        const Body& body = system_->bodies[i];
        const BodyStyleDef own = i < body_styles.size() ? body_styles[i] : BodyStyleDef{};
        const Color color = own.color ? *own.color : style.palette[next_color++ % style.palette.size()];
        const double default_width_px = (body.is_net ? kNetWidthPerRopeWidth : 1.0) * rope_width_px_;
        const double radius_px = 0.5 * own.width_px.value_or(default_width_px);
        body_radius_px_.push_back(radius_px);
        ItemLayer& layer = layer_of(color, first_layer);
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
            layer.items.push_back({system_->bars[k].a, system_->bars[k].b, radius_px});
    }
}

void SceneView::add_bars(const StyleDef& style, bool real) {
    const double width_px =
        style.bar_width_px.value_or(std::max(kThinnestBarPx, kBarWidthPerRopeWidth * rope_width_px_));
    ItemLayer layer{real ? style.real_bar_color : style.imaginary_bar_color, {}};
    for (const Bar& bar : system_->bars) {
        if ((bar.reach == 1) == real) layer.items.push_back({bar.a, bar.b, 0.5 * width_px});
    }
    layers_.push_back(std::move(layer));
}

void SceneView::add_markers(const StyleDef& style, bool pinned) {
    const double rim_px = height_ / (pinned ? kHeightPerPinnedRim : kHeightPerFreeRim);
    ItemLayer layer{pinned ? style.pinned_color : style.free_color, {}};
    for (std::size_t b = 0; b < system_->bodies.size(); ++b) {
        const Body& body = system_->bodies[b];
        const double radius_px = style.marker_radius_px.value_or(body_radius_px_[b] + rim_px);
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
            if (system_->is_pinned(i) == pinned) layer.items.push_back({i, i, radius_px});
        }
    }
    layers_.push_back(std::move(layer));
}

void SceneView::draw(const State& state, const Camera& camera, DrawList& list) const {
    list.width = width_;
    list.height = height_;
    list.background = background_;
    list.capsules.clear();
    list.layers.clear();
    list.bounds = {};
    for (const ItemLayer& layer : layers_) {
        const std::size_t first = list.capsules.size();
        for (const Item& item : layer.items) {
            const PixelPoint a{camera.x_px(state.x_m[item.a]), camera.y_px(state.y_m[item.a])};
            const PixelPoint b{camera.x_px(state.x_m[item.b]), camera.y_px(state.y_m[item.b])};
            const auto capsule = make_capsule(a, b, item.radius_px, width_, height_);
            if (!capsule) continue;
            list.bounds = list.bounds.united(capsule_bounds(*capsule, width_, height_));
            list.capsules.push_back(*capsule);
        }
        list.layers.push_back({layer.color, first, list.capsules.size() - first});
    }
}

}  // namespace corda::view
