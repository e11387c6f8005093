#include "corda/render/tiles.hpp"

#include <algorithm>
#include <cmath>

#include "corda/view/capsule.hpp"

namespace corda::render {

template <class Visit>
void Tiles::for_each_tile(const view::Capsule& capsule, const view::DrawList& list,
                          const Visit& visit) const {
    const PixelRect box = view::capsule_bounds(capsule, list.width, list.height);
    if (box.empty()) return;
    const float extent = std::max(capsule.radius, capsule.halo_radius) + view::kEdgeMargin;
    for (int row = box.y0 / kSidePx; row <= (box.y1 - 1) / kSidePx; ++row) {
        // The part of the segment that is not too far above or below this row.
        float from = 0.0F;
        float to = capsule.length;
        if (capsule.uy != 0.0F) {
            const float top = (static_cast<float>(row * kSidePx) - extent - capsule.ay) / capsule.uy;
            const float bottom = (static_cast<float>((row + 1) * kSidePx) + extent - capsule.ay) / capsule.uy;
            from = std::max(from, std::min(top, bottom));
            to = std::min(to, std::max(top, bottom));
        }
        const float x0 = capsule.ax + from * capsule.ux;
        const float x1 = capsule.ax + to * capsule.ux;
        const int low = std::max(box.x0, static_cast<int>(std::floor(std::min(x0, x1) - extent)));
        const int high = std::min(box.x1, static_cast<int>(std::ceil(std::max(x0, x1) + extent)));
        for (int column = low / kSidePx; column * kSidePx < high; ++column) visit(row * columns_ + column);
    }
}

void Tiles::plan(const view::DrawList& list) {
    columns_ = (list.width + kSidePx - 1) / kSidePx;
    const int rows = (list.height + kSidePx - 1) / kSidePx;
    last_layer_.assign(static_cast<std::size_t>(columns_) * rows, 0);
    tiles_.clear();
    batches_.clear();
    std::size_t first_layer = 0;  // of the batch
    for (std::size_t l = 0; l < list.layers.size(); ++l) {
        const view::Layer& layer = list.layers[l];
        if (layer.capsule_count == 0) continue;
        touched_.clear();
        bool overlaps = batches_.empty() || batches_.back().is_tinted != layer.is_tinted;
        for (std::size_t i = 0; i < layer.capsule_count; ++i) {
            for_each_tile(list.capsules[layer.first_capsule + i], list, [&](std::size_t tile) {
                if (last_layer_[tile] == l + 1) return;
                overlaps |= last_layer_[tile] > first_layer;
                last_layer_[tile] = l + 1;
                touched_.push_back(tile);
            });
        }
        if (overlaps) {
            batches_.push_back({.first_capsule = layer.first_capsule,
                                .first_tile = tiles_.size(),
                                .is_tinted = layer.is_tinted});
            first_layer = l;
        }
        Batch& batch = batches_.back();
        batch.capsule_count = layer.first_capsule + layer.capsule_count - batch.first_capsule;
        batch.tile_count += touched_.size();
        for (const std::size_t tile : touched_) {
            const int x0 = static_cast<int>(tile) % columns_ * kSidePx;
            const int y0 = static_cast<int>(tile) / columns_ * kSidePx;
            tiles_.push_back({static_cast<float>(x0), static_cast<float>(y0),
                              static_cast<float>(std::min(x0 + kSidePx, list.width)),
                              static_cast<float>(std::min(y0 + kSidePx, list.height)), layer.color, -1});
        }
    }
    plan_stamps(list);
}

void Tiles::plan_stamps(const view::DrawList& list) {
    std::size_t first = 0;  // of the batch
    for (std::size_t i = 0; i < list.stamps.size(); ++i) {
        const view::Stamp& stamp = list.stamps[i];
        const PixelRect& box = stamp.box;
        const auto meets = [&](const view::Stamp& other) { return !other.box.intersected(box).empty(); };
        if (i == 0 || std::any_of(&list.stamps[first], &list.stamps[i], meets)) {
            first = i;
            batches_.push_back({.first_tile = tiles_.size(), .is_stamps = true});
        }
        ++batches_.back().tile_count;
        tiles_.push_back({static_cast<float>(box.x0), static_cast<float>(box.y0), static_cast<float>(box.x1),
                          static_cast<float>(box.y1), stamp.color,
                          stamp.first_coverage == view::Stamp::kSolid
                              ? -1
                              : static_cast<std::int32_t>(stamp.first_coverage)});
    }
}

}  // namespace corda::render
