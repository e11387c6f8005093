#include "corda/render/tiles.hpp"

#include <algorithm>
#include <cmath>

#include "corda/render/coverage.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {
namespace {

/// Number of tiles along a side of a frame.
int tiles_along(int side_px) {
    return (side_px + Tiles::kSidePx - 1) / Tiles::kSidePx;
}

/// Overhead of a read in pixels of two bytes. On the CPU, no value up to this one made a measurable
/// difference. A GPU's driver takes some microseconds per call, in which the bus carries about this number of
/// pixels.
constexpr std::size_t kReadPx = 1 << 14;
/// The same for tinted layers, which also have sums.
constexpr std::size_t kTintedReadPx = kReadPx * 2 / (2 + sizeof(TintSums));

}  // namespace

template <class Visit>
void Tiles::for_each_tile(const view::Capsule& capsule, const view::DrawList& list,
                          const Visit& visit) const {
    const PixelRect box = view::capsule_bounds(capsule, list.width, list.height);
    if (box.empty()) return;
    const float extent = std::max(capsule.radius, capsule.halo_radius) + view::kEdgeMargin;
    for (int row = box.y0 / kSidePx; row <= (box.y1 - 1) / kSidePx; ++row) {
        // The part of the segment that is close enough to this row.
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
    columns_ = tiles_along(list.width);
    last_layer_.assign(tile_count(list.width, list.height), 0);
    tiles_ = 0;
    runs_.clear();
    batches_.clear();
    std::size_t first_layer = 0;  // of the current batch
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
                                .first_run = runs_.size(),
                                .is_tinted = layer.is_tinted});
            first_layer = l;
        }
        Batch& batch = batches_.back();
        batch.capsule_count = layer.first_capsule + layer.capsule_count - batch.first_capsule;
        add_runs(list, layer.color);
        batch.run_count = runs_.size() - batch.first_run;
    }
    touched_by_any_.resize(last_layer_.size());
    std::transform(last_layer_.begin(), last_layer_.end(), touched_by_any_.begin(),
                   [](std::size_t layer) { return static_cast<std::uint8_t>(layer > 0); });
}

void Tiles::add_runs(const view::DrawList& list, Color color) {
    tiles_ += touched_.size();
    std::ranges::sort(touched_);
    std::size_t last = 0;
    for (const std::size_t tile : touched_) {
        const PixelRect rect = tile_rect(tile, list.width, list.height);
        if (rect.x0 > 0 && tile != touched_.front() && tile == last + 1)
            runs_.back().rect.x1 = rect.x1;
        else
            runs_.push_back({rect, color});
        last = tile;
    }
}

std::size_t tile_count(int width, int height) {
    return static_cast<std::size_t>(tiles_along(width)) * tiles_along(height);
}

PixelRect tile_rect(std::size_t index, int width, int height) {
    constexpr int kSidePx = Tiles::kSidePx;
    const int columns = tiles_along(width);
    const int x0 = static_cast<int>(index) % columns * kSidePx;
    const int y0 = static_cast<int>(index) / columns * kSidePx;
    return {x0, y0, std::min(x0 + kSidePx, width), std::min(y0 + kSidePx, height)};
}

void mark_tiles(const PixelRect& box, int frame_width, std::vector<std::uint8_t>& tiles) {
    constexpr int kSidePx = Tiles::kSidePx;
    const int columns = tiles_along(frame_width);
    for (int row = box.y0 / kSidePx; row * kSidePx < box.y1; ++row)
        for (int column = box.x0 / kSidePx; column * kSidePx < box.x1; ++column)
            tiles[static_cast<std::size_t>(row) * columns + column] = 1;
}

std::vector<PixelRect> rects_of(const std::vector<std::uint8_t>& tiles, int width, int height) {
    constexpr int kSidePx = Tiles::kSidePx;
    const int columns = tiles_along(width);
    std::vector<PixelRect> rects;
    for (int y = 0; y < height; y += kSidePx) {
        const std::uint8_t* row = &tiles[static_cast<std::size_t>(y / kSidePx) * columns];
        for (int column = 0; column < columns; ++column) {
            if (row[column] == 0) continue;
            const int first = column;
            while (column < columns && row[column] != 0) ++column;
            rects.push_back(
                {first * kSidePx, y, std::min(column * kSidePx, width), std::min(y + kSidePx, height)});
        }
    }
    return rects;
}

std::size_t pixels_of(const PixelRect& rect) {
    return rect.empty() ? 0 : static_cast<std::size_t>(rect.width()) * rect.height();
}

std::size_t pixels_of(std::span<const Read> reads) {
    std::size_t pixels = 0;
    for (const Read& read : reads) pixels += pixels_of(read.rect);
    return pixels;
}

std::vector<std::span<const Read>> slices_of(std::span<const Read> reads) {
    std::vector<std::span<const Read>> slices;
    for (std::size_t first = 0, end = 0; first < reads.size(); first = end) {
        std::size_t pixels = pixels_of(reads[end++].rect);
        while (end < reads.size() && (pixels += pixels_of(reads[end].rect)) <= kMaxReadPx) ++end;
        slices.push_back(reads.subspan(first, end - first));
    }
    return slices;
}

std::vector<Read> plan_reads(const Tiles& tiles, const PixelRect& band) {
    std::vector<Read> reads;
    for (const Batch& batch : tiles.batches()) {
        const std::size_t cost_px = batch.is_tinted ? kTintedReadPx : kReadPx;
        for (std::size_t run = batch.first_run; run < batch.first_run + batch.run_count; ++run) {
            const PixelRect rect = tiles.runs()[run].rect.intersected(band);
            if (rect.empty()) continue;
            const bool is_first = reads.empty() || reads.back().batch != &batch;
            if (!is_first) {
                Read& last = reads.back();
                const PixelRect both = last.rect.united(rect);
                const std::size_t apart = pixels_of(last.rect) + pixels_of(rect) + cost_px;
                if (pixels_of(both) <= std::min(apart, kMaxReadPx)) {
                    last.rect = both;
                    last.end_run = run + 1;
                    continue;
                }
            }
            reads.push_back({.rect = rect,
                             .batch = &batch,
                             .first_run = run,
                             .end_run = run + 1,
                             .is_first_of_batch = is_first});
        }
    }
    return reads;
}

}  // namespace corda::render
