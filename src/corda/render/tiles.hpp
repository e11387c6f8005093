#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// Adjacent tiles of one row in which one layer is painted.
struct TileRun {
    PixelRect rect;
    Color color;
};

/// Layers that are drawn together because no two of them share a tile. All are tinted, or none is.
struct Batch {
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
    std::size_t first_run = 0;
    std::size_t run_count = 0;
    bool is_tinted = false;
};

/// The tiles that the capsules of each layer may touch, and the order in which layers are painted.
class Tiles {
  public:
    /// Side of a tile in pixels: that of a macroblock. Larger tiles would be fewer, but a thin line would
    /// leave most of them empty.
    static constexpr int kSidePx = 16;

    /// Replaces the plan, reusing its memory.
    void plan(const view::DrawList& list);

    /// Inside the frame. The runs of a batch do not overlap.
    [[nodiscard]] const std::vector<TileRun>& runs() const { return runs_; }
    /// Total number of tiles of the runs.
    [[nodiscard]] std::size_t tiles() const { return tiles_; }
    /// Per tile of the frame, row by row: 1 if a layer is painted there, else 0.
    [[nodiscard]] const std::vector<std::uint8_t>& touched() const { return touched_by_any_; }
    /// In painting order; contiguous in runs and capsules.
    [[nodiscard]] const std::vector<Batch>& batches() const { return batches_; }

  private:
    /// Calls `visit` with the index of every tile that the capsule may touch.
    template <class Visit>
    void for_each_tile(const view::Capsule& capsule, const view::DrawList& list, const Visit& visit) const;
    /// Adds the tiles of touched_ as runs.
    void add_runs(const view::DrawList& list, Color color);

    int columns_ = 0;
    std::size_t tiles_ = 0;
    std::vector<std::size_t> last_layer_;  ///< per tile, counted from 1; 0: none
    std::vector<std::size_t> touched_;     ///< tiles of the current layer
    std::vector<std::uint8_t> touched_by_any_;
    std::vector<TileRun> runs_;
    std::vector<Batch> batches_;
};

/// Number of tiles of a frame.
[[nodiscard]] std::size_t tile_count(int width, int height);

/// A tile of a frame by its index, row by row.
[[nodiscard]] PixelRect tile_rect(std::size_t index, int width, int height);

/// Sets the tiles that `box`, a part of the frame, touches to 1.
void mark_tiles(const PixelRect& box, int frame_width, std::vector<std::uint8_t>& tiles);

/// The tiles that are 1 as rectangles that do not overlap.
[[nodiscard]] std::vector<PixelRect> rects_of(const std::vector<std::uint8_t>& tiles, int width, int height);

/// A rectangle of masks that is read back in one call.
struct Read {
    PixelRect rect;
    const Batch* batch = nullptr;
    std::size_t first_run = 0;  ///< the runs inside the rectangle
    std::size_t end_run = 0;
    bool is_first_of_batch = false;
};

/// Maximum number of pixels that are read before they are painted: a row of tiles of the widest frame.
inline constexpr std::size_t kMaxReadPx = std::size_t{kMaxSidePx} * Tiles::kSidePx;

/// The reads of all runs within the rows of `band`, in the order of the runs. Consecutive runs of a batch
/// share a read of at most kMaxReadPx if the pixels between them cost less than a second read.
[[nodiscard]] std::vector<Read> plan_reads(const Tiles& tiles, const PixelRect& band);

/// Consecutive reads in slices of at most kMaxReadPx.
[[nodiscard]] std::vector<std::span<const Read>> slices_of(std::span<const Read> reads);

[[nodiscard]] std::size_t pixels_of(const PixelRect& rect);
[[nodiscard]] std::size_t pixels_of(std::span<const Read> reads);

}  // namespace corda::render
