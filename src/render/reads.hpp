#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/render/tiles.hpp"

namespace corda::render {

/// A rectangle of masks that is read at once.
struct Read {
    PixelRect rect;
    const Batch* batch = nullptr;  ///< whose masks they are
    std::size_t first_run = 0;     ///< the runs that lie in it
    std::size_t end_run = 0;
    bool is_first_of_batch = false;
};

/// The most pixels that are read before they are painted: a row of tiles of the widest frame.
inline constexpr std::size_t kMaxReadPx = std::size_t{kMaxSidePx} * Tiles::kSidePx;

/// The reads of all runs in some rows, in the order of the runs. Runs of a batch that follow one another are
/// one read, within kMaxReadPx, if the pixels between them take less time than a second read would.
[[nodiscard]] std::vector<Read> plan_reads(const Tiles& tiles, const PixelRect& band);

/// Reads that follow one another, in parts within kMaxReadPx.
[[nodiscard]] std::vector<std::span<const Read>> slices_of(std::span<const Read> reads);

[[nodiscard]] std::size_t pixels_of(const PixelRect& rect);
[[nodiscard]] std::size_t pixels_of(std::span<const Read> reads);

}  // namespace corda::render
