#include "corda/media/animation/palette.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace corda::media {
namespace {

constexpr std::size_t kMaxKnown = 1 << 20;
constexpr int kHalfOpaque = 128;

std::uint32_t packed(const std::uint8_t* p) {
    return static_cast<std::uint32_t>(p[0]) << 16 | static_cast<std::uint32_t>(p[1]) << 8 | p[2];
}

Color color_of(std::uint32_t rgb) {
    return {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
            static_cast<std::uint8_t>(rgb)};
}

int level(const PaletteBin& bin, std::size_t channel) {
    return static_cast<int>(bin.sums[channel] / bin.count);
}

std::uint64_t weight(const PaletteBin& bin) {
    return static_cast<std::uint64_t>(std::bit_width(bin.count));
}

/// Bins first <= i < last of a list.
struct Box {
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t channel = 0;   ///< the widest
    std::uint64_t weight = 0;  ///< its width times the weights of its bins
};

Box box_of(const std::vector<PaletteBin>& bins, std::size_t first, std::size_t last) {
    Box box{first, last, 0, 0};
    int widest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        int low = 255;
        int high = 0;
        for (std::size_t i = first; i < last; ++i) {
            low = std::min(low, level(bins[i], c));
            high = std::max(high, level(bins[i], c));
        }
        if (high - low <= widest) continue;
        widest = high - low;
        box.channel = c;
    }
    for (std::size_t i = first; i < last; ++i) box.weight += weight(bins[i]);
    box.weight *= static_cast<std::uint64_t>(widest);
    return box;
}

/// Sorts the bins of a box along its widest side and returns where half of their weight ends.
std::size_t sort_and_cut(std::vector<PaletteBin>& bins, const Box& box) {
    const auto begin = bins.begin() + static_cast<std::ptrdiff_t>(box.first);
    const auto end = bins.begin() + static_cast<std::ptrdiff_t>(box.last);
    // Stable: bins begin in the order of their colours, so the result depends on nothing else.
    std::ranges::stable_sort(begin, end, {}, [&](const PaletteBin& bin) { return level(bin, box.channel); });
    std::uint64_t all = 0;
    for (auto bin = begin; bin != end; ++bin) all += weight(*bin);
    std::uint64_t half = 0;
    std::size_t cut = box.first;
    while (2 * half < all) half += weight(bins[cut++]);
    return std::clamp(cut, box.first + 1, box.last - 1);
}

Color mean_color(const std::vector<PaletteBin>& bins, const Box& box) {
    PaletteBin sum;
    for (std::size_t i = box.first; i < box.last; ++i) {
        sum.count += bins[i].count;
        for (std::size_t c = 0; c < 3; ++c) sum.sums[c] += bins[i].sums[c];
    }
    const auto mean = [&sum](std::size_t c) {
        return static_cast<std::uint8_t>((sum.sums[c] + sum.count / 2) / sum.count);
    };
    return {mean(0), mean(1), mean(2)};
}

}  // namespace

std::array<std::uint8_t, 4> Palette::bgra(std::size_t index) const {
    if (index == kTransparent) return {};
    if (index >= colors_.size()) return {0, 0, 0, 255};
    const Color& color = colors_[index];
    return {color.b, color.g, color.r, 255};
}

std::uint8_t Palette::nearest(std::uint32_t rgb) const {
    const Color wanted = color_of(rgb);
    int least = std::numeric_limits<int>::max();
    std::size_t best = 0;
    for (std::size_t i = 0; i < colors_.size(); ++i) {
        const int r = colors_[i].r - wanted.r;
        const int g = colors_[i].g - wanted.g;
        const int b = colors_[i].b - wanted.b;
        // The eye sees green best, blue worst.
        const int distance = 2 * r * r + 4 * g * g + b * b;
        if (distance >= least) continue;
        least = distance;
        best = i;
    }
    return static_cast<std::uint8_t>(best);
}

void Palette::map(const std::uint8_t* rgba, int count, std::uint8_t* indices) {
    if (known_.size() > kMaxKnown) known_.clear();
    std::uint32_t last = 0;
    int last_index = -1;
    for (int x = 0; x < count; ++x, rgba += 4) {
        if (rgba[3] < kHalfOpaque) {
            indices[x] = kTransparent;
            continue;
        }
        const std::uint32_t rgb = packed(rgba);
        if (last_index < 0 || rgb != last) {
            const auto [entry, is_new] = known_.try_emplace(rgb, std::uint8_t{0});
            if (is_new) entry->second = nearest(rgb);
            last = rgb;
            last_index = entry->second;
        }
        indices[x] = static_cast<std::uint8_t>(last_index);
    }
}

void PaletteMaker::add(const std::uint8_t* rgba, std::uint64_t count) {
    if (count == 0 || rgba[3] < kHalfOpaque) return;
    const std::uint32_t rgb = packed(rgba);
    if (exact_.size() <= kMaxColors) exact_.insert(rgb);
    constexpr unsigned kDropped = 8 - kBits;
    const std::array<std::uint64_t, 3> levels{rgba[0], rgba[1], rgba[2]};
    PaletteBin& bin =
        bins_[levels[0] >> kDropped << (2 * kBits) | levels[1] >> kDropped << kBits | levels[2] >> kDropped];
    bin.count += count;
    for (std::size_t c = 0; c < 3; ++c) bin.sums[c] += count * levels[c];
}

std::vector<Color> PaletteMaker::cut_boxes() const {
    std::vector<PaletteBin> bins;
    for (const PaletteBin& bin : bins_)
        if (bin.count > 0) bins.push_back(bin);
    std::vector<Box> boxes;
    if (!bins.empty()) boxes.push_back(box_of(bins, 0, bins.size()));
    while (!boxes.empty() && boxes.size() < kMaxColors) {
        const auto heaviest = std::ranges::max_element(boxes, {}, &Box::weight);
        if (heaviest->weight == 0) break;
        const Box box = *heaviest;
        const std::size_t cut = sort_and_cut(bins, box);
        *heaviest = box_of(bins, box.first, cut);
        boxes.push_back(box_of(bins, cut, box.last));
    }
    std::vector<Color> colors;
    for (const Box& box : boxes) colors.push_back(mean_color(bins, box));
    return colors;
}

Palette PaletteMaker::make() const {
    if (exact_.size() > kMaxColors) return Palette(cut_boxes());
    std::vector<std::uint32_t> sorted(exact_.begin(), exact_.end());
    std::ranges::sort(sorted);  // the order of the set is no order
    std::vector<Color> colors;
    for (const std::uint32_t rgb : sorted) colors.push_back(color_of(rgb));
    return Palette(std::move(colors));
}

}  // namespace corda::media
