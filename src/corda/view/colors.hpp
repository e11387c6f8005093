#pragma once

#include <array>
#include <span>
#include <vector>

#include "corda/sim/recording.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Colours of a scene: from its style, otherwise from its theme.
struct ThemeColors {
    Ground ground;
    std::vector<Color> palette;
    Color support;  ///< plates and rings, which do not move
    Color outline;  ///< of balls
    Color pinned;
    Color free;
    Color real_bar;
    Color imaginary_bar;
};

[[nodiscard]] ThemeColors theme_colors(const StyleDef& style);

/// Opacity of pose `k` of `count` in one picture: 1 for the last one, decreasing with age.
[[nodiscard]] double pose_opacity(std::size_t k, std::size_t count);

/// A colour that can be read on the background; on a transparent background, the theme's.
[[nodiscard]] Color text_color(const ThemeColors& colors);

/// A colour of arrows that stands out from the background.
[[nodiscard]] Color arrow_color(const StyleDef& style);

/// The colour at a share, 0 .. 1, of the way through some colours at even distances; at least one.
[[nodiscard]] Color mixed_color(std::span<const Color> colors, double share);

/// Colour scale of a quantity for all pictures of a film: linear from `low` to `high`.
struct ColorScale {
    Quantity quantity = Quantity::kTension;
    double low = 0.0;
    double high = 1.0;
    bool is_cut_low = false;        ///< values lie below the end; few, unless the scale is given
    bool is_cut_high = false;       ///< and above it
    std::array<Color, 9> colors{};  ///< between which others are mixed
    Color unknown;                  ///< for NaN

    [[nodiscard]] Color color(double value) const;
};

/// A round end of a scale that is not below `value` and not above 2 times it: a digit whose half is short,
/// times a power of 10.
[[nodiscard]] double rounded_end(double value);

/// The scale of a quantity: StyleDef::color_range; without it from 0 to high, or from -high to high through
/// grey if there are values well below 0. `high` is a round number above the largest value, or above 98 % of
/// the values if that is less than half of the largest. The colours from -high to high go through grey.
[[nodiscard]] ColorScale scale_of(Quantity quantity, const sim::Histogram& histogram, const StyleDef& style);

}  // namespace corda::view
