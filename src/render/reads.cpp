#include "corda/render/reads.hpp"

#include <algorithm>

#include "corda/render/coverage.hpp"

namespace corda::render {
namespace {

/// What a read costs besides its pixels, in pixels of two bytes. On the CPU no value up to this one made a
/// measurable difference; a GPU's driver takes some microseconds for a call, in which the bus carries about
/// as many pixels.
constexpr std::size_t kReadPx = 1 << 14;
/// Of tinted layers: a pixel has its sums beside the two bytes.
constexpr std::size_t kTintedReadPx = kReadPx * 2 / (2 + sizeof(TintSums));

}  // namespace

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
