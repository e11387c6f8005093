#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Tiles side by side in which one layer is painted.
struct TileRun {
    PixelRect rect;
    Color color;
};

/// Layers, tinted ones or others, that can be painted at once, because no two of them have a tile in common.
struct Batch {
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
    std::size_t first_run = 0;
    std::size_t run_count = 0;
    bool is_tinted = false;  ///< of its layers
};

/// Where the layers of a draw list are painted, in what order: each in the tiles that its capsules may touch.
class Tiles {
  public:
    /// Side of a tile in pixels: that of a macroblock. Larger ones are fewer, but of a thin line mostly
    /// ground.
    static constexpr int kSidePx = 16;

    /// Memory of the last call is reused.
    void plan(const view::DrawList& list);

    /// Inside the frame; of a batch no two overlap.
    [[nodiscard]] const std::vector<TileRun>& runs() const { return runs_; }
    /// How many tiles the runs are.
    [[nodiscard]] std::size_t tiles() const { return tiles_; }
    /// Per tile of the frame, row by row: whether a layer is painted there, 0 or 1.
    [[nodiscard]] const std::vector<std::uint8_t>& touched() const { return touched_by_any_; }
    /// In the order in which they are to be painted; contiguous in runs and capsules.
    [[nodiscard]] const std::vector<Batch>& batches() const { return batches_; }

  private:
    /// Calls `visit` with the index of every tile that the capsule may touch.
    template <class Visit>
    void for_each_tile(const view::Capsule& capsule, const view::DrawList& list, const Visit& visit) const;
    /// Adds the tiles of touched_ as runs.
    void add_runs(const view::DrawList& list, Color color);

    int columns_ = 0;
    std::size_t tiles_ = 0;
    std::vector<std::size_t> last_layer_;  ///< per tile, from 1 on; 0: none
    std::vector<std::size_t> touched_;     ///< by a layer
    std::vector<std::uint8_t> touched_by_any_;
    std::vector<TileRun> runs_;
    std::vector<Batch> batches_;
};

/// The number of tiles of a frame.
[[nodiscard]] std::size_t tile_count(int width, int height);

/// A tile of a frame by its index, row by row.
[[nodiscard]] PixelRect tile_rect(std::size_t index, int width, int height);

/// Marks the tiles of a frame that `box`, a part of it, touches by 1.
void mark_tiles(const PixelRect& box, int frame_width, std::vector<std::uint8_t>& tiles);

/// Some tiles of a frame, marked by 1, as rectangles that do not overlap.
[[nodiscard]] std::vector<PixelRect> rects_of(const std::vector<std::uint8_t>& tiles, int width, int height);

}  // namespace corda::render
