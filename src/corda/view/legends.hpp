#pragma once

#include <optional>
#include <string>

#include "corda/view/arrows.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/overlay_texts.hpp"

namespace corda::view {

/// The legend of colours at the upper right.
struct ColorLegend {
    ColorScale scale;
    std::string name, first, middle, last;
    int x_px = 0;  ///< its left end
    int bar_x_px = 0;
    int bar_end_px = 0;
};

/// Baseline of its numbers.
[[nodiscard]] int legend_baseline_px(const TextArea& area);

/// Lays a legend out; std::nullopt if there is no room.
[[nodiscard]] std::optional<ColorLegend> make_color_legend(const TextArea& area, const ColorScale& scale);

/// Adds the legend as stamps.
void draw_legend(const TextArea& area, const ColorLegend& legend, DrawList& list);

/// The legend of arrows at the lower right: a size, "2 m/s", and its arrow.
struct ArrowLegend {
    std::string text;
    int x_px = 0;  ///< its left end
    double arrow_px = 0.0;
    Color color;
    bool is_cut = false;  ///< some arrows are larger
};

/// Lays a legend out; std::nullopt without arrows, or if there is no room from `begin_px` on.
[[nodiscard]] std::optional<ArrowLegend> make_arrow_legend(const TextArea& area, const StyleDef& style,
                                                           const ArrowScale& scale, int begin_px);

/// Adds the arrow as a layer.
void draw_arrow(const TextArea& area, const ArrowLegend& legend, DrawList& list);

/// Adds a scale bar that ends at `right_px` if it begins after `begin_px`; returns where other items must
/// end.
[[nodiscard]] int draw_scale_bar(const TextArea& area, double pixels_per_metre, int begin_px, int right_px,
                                 DrawList& list);

}  // namespace corda::view
