#include "corda/view/draw_list.hpp"

#include "corda/view/capsule.hpp"

namespace corda::view {

void DrawList::clear() {
    capsules.clear();
    layers.clear();
    bounds = {};
}

void DrawList::add_layer(Color color) {
    layers.push_back({color, capsules.size(), 0});
}

void DrawList::add_capsule(PixelPoint a, PixelPoint b, double radius_px, double halo_px) {
    const auto capsule = make_capsule(a, b, radius_px, width, height, halo_px);
    if (!capsule) return;
    bounds = bounds.united(capsule_bounds(*capsule, width, height));
    capsules.push_back(*capsule);
    ++layers.back().capsule_count;
}

}  // namespace corda::view
