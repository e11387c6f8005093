#include "corda/media/read/color_patch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace corda::media {
namespace {

constexpr std::size_t kPatchCount = 5;
// Deblocking changes 3 pixels, the chroma filter reads 1, and an 8x8 transform block spreads over 8.
constexpr int kMargin = 8;

/// How much a channel may change from one pixel to the next: a dithered ground that changes slowly is no
/// edge.
constexpr int kLevels = 4;

bool like_rgb(const std::uint8_t* a, const std::uint8_t* b) {
    return std::abs(a[0] - b[0]) <= kLevels && std::abs(a[1] - b[1]) <= kLevels &&
           std::abs(a[2] - b[2]) <= kLevels;
}

bool is_even(const Image& frame, int x, int y) {
    const PixelRect block =
        PixelRect{x - kMargin, y - kMargin, x + kPatchSide + kMargin, y + kPatchSide + kMargin}.intersected(
            frame.rect());
    for (int row = block.y0; row < block.y1; ++row) {
        for (int column = block.x0; column < block.x1; ++column) {
            const std::uint8_t* pixel = frame.pixel(column, row);
            if (column > block.x0 && !like_rgb(pixel, frame.pixel(column - 1, row))) return false;
            if (row > block.y0 && !like_rgb(pixel, frame.pixel(column, row - 1))) return false;
        }
    }
    return true;
}

/// Block-aligned positions, those most likely to differ in colour first: corners, centre, middles of the
/// edges, then all, row by row.
std::vector<std::array<int, 2>> positions(const Image& frame) {
    const int columns = frame.width() / kPatchSide;
    const int rows = frame.height() / kPatchSide;
    if (columns == 0 || rows == 0) return {};
    const std::array<int, 3> xs{0, columns - 1, columns / 2};
    const std::array<int, 3> ys{0, rows - 1, rows / 2};
    std::vector<std::array<int, 2>> result;
    for (const int row : ys) {
        for (const int column : xs) result.push_back({column * kPatchSide, row * kPatchSide});
    }
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column)
            result.push_back({column * kPatchSide, row * kPatchSide});
    }
    return result;
}

bool has_color(const std::vector<ColorPatch>& patches, const ColorPatch& patch) {
    return std::ranges::any_of(patches, [&](const ColorPatch& p) { return p.rgb == patch.rgb; });
}

bool has_place(const std::vector<ColorPatch>& patches, const ColorPatch& patch) {
    return std::ranges::any_of(patches,
                               [&](const ColorPatch& p) { return p.x == patch.x && p.y == patch.y; });
}

}  // namespace

std::array<double, 3> mean_rgb(const Image& frame, int x, int y) {
    constexpr int kPixels = kPatchSide * kPatchSide;
    std::array<double, 3> mean{};
    for (int i = 0; i < kPixels; ++i) {
        const std::uint8_t* const pixel = frame.pixel(x + i % kPatchSide, y + i / kPatchSide);
        for (std::size_t c = 0; c < mean.size(); ++c) mean[c] += pixel[c];
    }
    for (double& channel : mean) channel /= kPixels;
    return mean;
}

std::vector<ColorPatch> choose_patches(const Image& frame) {
    std::vector<ColorPatch> chosen;
    std::vector<ColorPatch> spare;  // further places with a colour that is already chosen
    for (const auto& [x, y] : positions(frame)) {
        const auto [r, g, b] = mean_rgb(frame, x, y);
        const auto rounded = [](double level) { return static_cast<std::uint8_t>(std::lround(level)); };
        const ColorPatch patch{x, y, {rounded(r), rounded(g), rounded(b)}};
        const bool new_color = !has_color(chosen, patch);
        if (!new_color && spare.size() >= kPatchCount) continue;
        if (has_place(chosen, patch) || has_place(spare, patch) || !is_even(frame, x, y)) continue;
        (new_color ? chosen : spare).push_back(patch);
        if (chosen.size() == kPatchCount) return chosen;
    }
    for (std::size_t i = 0; i < spare.size() && chosen.size() < kPatchCount; ++i) chosen.push_back(spare[i]);
    return chosen;
}

double patch_error(const ColorPatch& patch, const std::array<double, 3>& shown) {
    double worst = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(std::clamp(shown[c], 0.0, 255.0) - patch.rgb[c]));
    return worst;
}

double patch_tolerance(int crf, bool has_full_chroma) {
    // x264 quantises the colour of 4:4:4 more coarsely: dark grounds are off by 5.5 at crf 24 and 6.5 at 30,
    // as 4:2:0 is at 9 more.
    if (has_full_chroma) crf = std::min(crf + 9, 51);
    // Measured with random and saturated colours and five presets: at most 1.7 up to crf 25 (of which 1.6 is
    // the rounding to 8-bit Y'CbCr), 3.2 at 28, 3.9 at 33, 6.5 at 40, 11 at 45, 25 at 51. A wrong matrix or
    // range is off by 15 or more.
    return std::max(2.0, 2.0 * std::exp2((crf - 21) / 7.0));
}

}  // namespace corda::media
