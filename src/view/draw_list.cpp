#include "corda/view/draw_list.hpp"

#include <algorithm>

#include "corda/view/capsule.hpp"

namespace corda::view {

bool DrawList::has_tints() const {
    return std::any_of(layers.begin(), layers.end(), [](const Layer& layer) { return layer.is_tinted; });
}

bool DrawList::shows_nothing() const {
    const auto is_outside = [this](const Capsule& capsule) {
        const Surroundings box = surroundings(capsule, capsule.radius);
        return box.x1 <= 0.0F || box.y1 <= 0.0F || box.x0 >= static_cast<float>(width) ||
               box.y0 >= static_cast<float>(height);
    };
    return std::all_of(layers.begin(), layers.end(), [&](const Layer& layer) {
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

void DrawList::add_capsule(PixelPoint a, PixelPoint b, double radius_px, double halo_px, Tint tint) {
    auto capsule = make_capsule(a, b, radius_px, width, height, halo_px);
    if (!capsule) return;
    capsule->tint = tint;
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

}  // namespace corda::view
