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

/// The eye sees green best, blue worst.
constexpr std::array kWeights{2, 4, 1};

/// Weighted product of two differences of colours.
int product(const std::array<int, 3>& a, const std::array<int, 3>& b) {
    return kWeights[0] * a[0] * b[0] + kWeights[1] * a[1] * b[1] + kWeights[2] * a[2] * b[2];
}

std::array<int, 3> difference(const std::array<int, 3>& a, const Color& b) {
    return {a[0] - b.r, a[1] - b.g, a[2] - b.b};
}

/// The rank 0 .. 63 of a pixel in its 8x8 square: every second one comes first, and so on (B. E. Bayer: An
/// optimum method for two-level rendition of continuous-tone pictures. ICC 1973).
int bayer(int x, int y) {
    int rank = 0;
    for (int bit = 0; bit < 3; ++bit) rank = 4 * rank + 2 * (((x ^ y) >> bit) & 1) + ((y >> bit) & 1);
    return rank;
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

std::uint8_t Palette::nearest(const std::array<int, 3>& rgb) const {
    int least = std::numeric_limits<int>::max();
    std::size_t best = 0;
    for (std::size_t i = 0; i < colors_.size(); ++i) {
        const auto apart = difference(rgb, colors_[i]);
        const int distance = product(apart, apart);
        if (distance >= least) continue;
        least = distance;
        best = i;
    }
    return static_cast<std::uint8_t>(best);
}

Palette::Mix Palette::mix_of(std::uint32_t rgb) const {
    constexpr int kMaxApart = 24 * 24 * 7;  // a pattern of colours that differ more would be seen
    const Color color = color_of(rgb);
    const std::array<int, 3> wanted{color.r, color.g, color.b};
    Mix mix;
    mix.first = mix.second = nearest(wanted);
    const auto missing = difference(wanted, colors_[mix.first]);
    // The other entry is on the other side of the colour.
    mix.second = nearest({wanted[0] + missing[0], wanted[1] + missing[1], wanted[2] + missing[2]});
    const Color& second = colors_[mix.second];
    const auto apart = difference({second.r, second.g, second.b}, colors_[mix.first]);
    const int square = product(apart, apart);
    if (square > 0 && square <= kMaxApart)
        mix.share = static_cast<std::uint8_t>(std::clamp(64 * product(missing, apart) / square, 0, 63));
    return mix;
}

void Palette::map(const std::uint8_t* rgba, int count, int x, int y, std::uint8_t* indices) {
    if (known_.size() > kMaxKnown) known_.clear();
    std::uint32_t last = 0;
    const Mix* mix = nullptr;  // of `last`
    for (int i = 0; i < count; ++i, rgba += 4) {
        if (rgba[3] < kHalfOpaque) {
            indices[i] = kTransparent;
            continue;
        }
        const std::uint32_t rgb = packed(rgba);
        if (mix == nullptr || rgb != last) {
            const auto [entry, is_new] = known_.try_emplace(rgb);
            if (is_new) entry->second = mix_of(rgb);
            last = rgb;
            mix = &entry->second;
        }
        indices[i] = bayer(x + i, y) < mix->share ? mix->second : mix->first;
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
