#include "corda/view/legends.hpp"

#include <algorithm>
#include <cmath>

#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kBarLength = 0.3;
constexpr double kBarWidth = 1.0 / 400.0;

// Sizes as shares of the em.
constexpr double kTick = 0.4;  // at the ends of the scale bar
constexpr double kLegendHeight = 0.6;
constexpr double kLegendTick = 0.2;
constexpr int kGradientStepPx = 2;

constexpr double kBarPerWidth = 0.2;

void draw_gradient(const ColorScale& scale, const PixelRect& bar, DrawList& list) {
    for (int x = bar.x0; x < bar.x1; x += kGradientStepPx) {
        const int end = std::min(x + kGradientStepPx, bar.x1);
        const double share = (0.5 * (x + end) - bar.x0) / bar.width();
        list.add_box({x, bar.y0, end, bar.y1}, scale.color(scale.low + share * (scale.high - scale.low)));
    }
}

}  // namespace

int legend_baseline_px(const TextArea& area) {
    return area.edge_px + rounded((2.0 * kAscent + kLegendTick + kGap) * area.em_px);
}

std::optional<ColorLegend> make_color_legend(const TextArea& area, const ColorScale& scale) {
    const NumberTitle title = title_of(scale);
    const auto number = [&](double value) {
        return localized(display_number(value / title.unit), area.language);
    };
    ColorLegend legend;
    legend.scale = scale;
    legend.name = translated(title.text, area.language);
    legend.first = (scale.is_cut_low ? "≤ " : "") + number(scale.low);
    legend.middle = number(0.5 * (scale.low + scale.high));
    legend.last = (scale.is_cut_high ? "≥ " : "") + number(scale.high);
    legend.bar_end_px = area.width_px - area.edge_px - area.font.width_px(legend.last, area.em_px) / 2;
    legend.bar_x_px = legend.bar_end_px - rounded(kBarLength * area.side_px);
    legend.x_px = legend.bar_x_px - rounded(kGap * area.em_px) - area.font.width_px(legend.name, area.em_px);
    if (legend.x_px < area.edge_px) return std::nullopt;
    return legend;
}

void draw_legend(const TextArea& area, const ColorLegend& legend, DrawList& list) {
    const auto half_px = [&](const std::string& text) { return area.font.width_px(text, area.em_px) / 2; };
    const int bar_px = legend.bar_end_px - legend.bar_x_px;
    const int baseline_px = area.edge_px + rounded(kAscent * area.em_px);
    area.font.write({legend.x_px, baseline_px, area.em_px, area.color, legend.name}, list);
    const int height_px = rounded(kLegendHeight * area.em_px);
    const int top_px = baseline_px - (rounded(kAscent * area.em_px) + height_px) / 2;
    draw_gradient(legend.scale, {legend.bar_x_px, top_px, legend.bar_end_px, top_px + height_px}, list);
    const int line_px = std::max(1, rounded(kBarWidth * area.side_px));
    const auto add_tick = [&](int tick_x_px, const std::string& text) {
        const int tick_end_px = top_px + height_px + std::max(1, rounded(kLegendTick * area.em_px));
        list.add_box({tick_x_px, top_px + height_px, tick_x_px + line_px, tick_end_px}, area.color);
        area.font.write(
            {tick_x_px + line_px / 2 - half_px(text), legend_baseline_px(area), area.em_px, area.color, text},
            list);
    };
    add_tick(legend.bar_x_px, legend.first);
    const int taken_px = std::max(half_px(legend.first), half_px(legend.last)) + half_px(legend.middle) +
                         rounded(kGap * area.em_px);
    if (taken_px <= bar_px / 2) add_tick((legend.bar_x_px + legend.bar_end_px - line_px) / 2, legend.middle);
    add_tick(legend.bar_end_px - line_px, legend.last);
}

std::optional<ArrowLegend> make_arrow_legend(const TextArea& area, const StyleDef& style,
                                             const ArrowScale& scale, int begin_px) {
    if (style.arrows == Arrows::kNone || !std::isnormal(scale.longest)) return std::nullopt;
    const double value = scale.is_cut ? scale.longest : round_number_below(scale.longest).value();
    const std::string size = quantity_text(value, style.arrows == Arrows::kVelocity ? "m/s" : "N");
    ArrowLegend legend;
    legend.text = (scale.is_cut ? "≥ " : "") + localized(size, area.language);
    legend.arrow_px = value * scale.pixels_per_unit;
    legend.x_px = area.width_px - area.edge_px - rounded(legend.arrow_px) - rounded(kGap * area.em_px) -
                  area.font.width_px(legend.text, area.em_px);
    legend.color = arrow_color(style);
    legend.is_cut = scale.is_cut;
    if (legend.x_px < begin_px) return std::nullopt;
    return legend;
}

void draw_arrow(const TextArea& area, const ArrowLegend& legend, DrawList& list) {
    list.add_layer(legend.color);
    list.layers.back().is_note = true;
    const double end_px = area.width_px - area.edge_px;
    const double y_px = area.height_px - area.edge_px - 0.5 * kAscent * area.em_px;
    add_arrow({end_px - legend.arrow_px, y_px}, {end_px, y_px}, area.side_px, false, legend.is_cut, list);
}

int draw_scale_bar(const TextArea& area, double pixels_per_metre, int begin_px, int right_px,
                   DrawList& list) {
    const double longest_px = std::min(kBarPerWidth * area.width_px, kBarLength * area.side_px);
    const double longest_m = longest_px / pixels_per_metre;
    if (!std::isnormal(longest_m)) return right_px;
    const RoundNumber number = round_number_below(longest_m);
    const int length_px = std::max(1, rounded(number.value() * pixels_per_metre));
    const std::string text = localized(length_text(number.digit, number.exponent), area.language);
    const int gap_px = rounded(kGap * area.em_px);
    const int text_px = right_px - length_px - gap_px - area.font.width_px(text, area.em_px);
    if (text_px < begin_px) return right_px;
    const int baseline_px = area.height_px - area.edge_px;
    area.font.write({text_px, baseline_px, area.em_px, area.color, text}, list);
    const int line_px = std::max(1, rounded(kBarWidth * area.side_px));
    const int tick_px = std::max(line_px + 1, rounded(kTick * area.em_px));
    const int left_px = right_px - length_px;
    list.add_box({left_px, baseline_px - line_px, right_px, baseline_px}, area.color);
    list.add_box({left_px, baseline_px - tick_px, left_px + line_px, baseline_px - line_px}, area.color);
    list.add_box({right_px - line_px, baseline_px - tick_px, right_px, baseline_px - line_px}, area.color);
    return text_px - rounded(kLine * area.em_px);
}

}  // namespace corda::view
