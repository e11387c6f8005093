#include "corda/media/encode/alpha_bleed.hpp"

#include <algorithm>
#include <cstddef>

namespace corda::media {

void AlphaBleed::search_row(const Image& image, int y, const PixelRect& grown, Found* row) const {
    const auto shows = [&](int x) { return image.pixel(x, y)[3] >= kMinAlpha; };
    constexpr int kNone = kReachPx + 1;
    int last = grown.x0 - kReachPx;  // the nearest pixel that shows, to the left
    bool has_last = false;
    for (int x = std::max(0, grown.x0 - kReachPx); x < grown.x0; ++x)
        if (shows(x)) {
            last = x;
            has_last = true;
        }
    for (int x = grown.x0; x < grown.x1; ++x) {
        if (shows(x)) {
            last = x;
            has_last = true;
        }
        const int distance = has_last ? std::min(x - last, kNone) : kNone;
        const std::uint8_t* const p = image.pixel(distance < kNone ? last : x, y);
        *row++ = {p[0], p[1], p[2], static_cast<std::uint8_t>(distance)};
    }
    // What is nearer to the right.
    int next = 0;
    bool has_next = false;
    for (int x = std::min(image.width(), grown.x1 + kReachPx) - 1; x >= grown.x0; --x) {
        if (x < grown.x1) --row;
        if (shows(x)) {
            next = x;
            has_next = true;
        }
        if (x >= grown.x1 || !has_next || next - x >= row->distance) continue;
        const std::uint8_t* const p = image.pixel(next, y);
        *row = {p[0], p[1], p[2], static_cast<std::uint8_t>(next - x)};
    }
}

PixelRect AlphaBleed::update(const Image& image, const PixelRect& part) {
    const bool is_new = picture_.width() != image.width() || picture_.height() != image.height();
    if (is_new) picture_ = Image(image.width(), image.height());
    const PixelRect changed = is_new ? image.rect() : part;
    const PixelRect grown =
        PixelRect{changed.x0 - kReachPx, changed.y0 - kReachPx, changed.x1 + kReachPx, changed.y1 + kReachPx}
            .intersected(image.rect());
    if (grown.empty()) return grown;
    const auto width = static_cast<std::size_t>(grown.width());
    const int first = std::max(0, grown.y0 - kReachPx);
    const int end = std::min(image.height(), grown.y1 + kReachPx);
    rows_.resize(width * static_cast<std::size_t>(end - first));
    for (int y = first; y < end; ++y)
        search_row(image, y, grown, &rows_[width * static_cast<std::size_t>(y - first)]);
    for (int y = grown.y0; y < grown.y1; ++y) {
        for (int x = grown.x0; x < grown.x1; ++x) {
            const std::uint8_t* const from = image.pixel(x, y);
            std::uint8_t* const to = picture_.pixel(x, y);
            std::copy_n(from, 4, to);
            if (from[3] >= kMinAlpha) continue;
            const Found* nearest = nullptr;
            int least = kReachPx * kReachPx + 1;  // squared
            for (int d = 0; d <= kReachPx && d * d < least; ++d) {
                for (const int row : {y - d, y + d}) {
                    if (row < first || row >= end) continue;
                    const Found& found = rows_[width * static_cast<std::size_t>(row - first) +
                                               static_cast<std::size_t>(x - grown.x0)];
                    const int square = d * d + found.distance * found.distance;
                    if (found.distance > kReachPx || square >= least) continue;
                    least = square;
                    nearest = &found;
                }
            }
            if (nearest == nullptr) continue;
            to[0] = nearest->r;
            to[1] = nearest->g;
            to[2] = nearest->b;
        }
    }
    return grown;
}

}  // namespace corda::media
