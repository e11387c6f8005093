#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// The part of a frame in which one layer or stamp is painted.
struct Tile {
    float x0 = 0;
    float y0 = 0;
    float x1 = 0;
    float y1 = 0;
    Color color;
    std::int32_t first_coverage = -1;  ///< of a stamp: see view::Stamp; -1: all of it is covered
};

/// Layers, tinted ones or others, or stamps that can be painted at once, because no two of them have a tile
/// in common.
struct Batch {
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
    std::size_t first_tile = 0;
    std::size_t tile_count = 0;
    bool is_stamps = false;  ///< one per tile
    bool is_tinted = false;  ///< of its layers
};

/// Where the layers and stamps of a draw list are painted, in what order. A layer is painted only in the
/// tiles that its capsules may touch; the box of a stamp is a tile.
class Tiles {
  public:
    /// Side of a tile in pixels: that of those in which llvmpipe draws.
    static constexpr int kSidePx = 64;

    /// Memory of the last call is reused.
    void plan(const view::DrawList& list);

    /// Inside the frame.
    [[nodiscard]] const std::vector<Tile>& tiles() const { return tiles_; }
    /// In the order in which they are to be painted; contiguous in tiles and capsules.
    [[nodiscard]] const std::vector<Batch>& batches() const { return batches_; }

  private:
    void plan_stamps(const view::DrawList& list);
    /// Calls `visit` with the index of every tile that the capsule may touch.
    template <class Visit>
    void for_each_tile(const view::Capsule& capsule, const view::DrawList& list, const Visit& visit) const;

    int columns_ = 0;
    std::vector<std::size_t> last_layer_;  ///< per tile, from 1 on; 0: none
    std::vector<std::size_t> touched_;     ///< by a layer
    std::vector<Tile> tiles_;
    std::vector<Batch> batches_;
};

}  // namespace corda::render
