#include "corda/view/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda::view {
namespace {

constexpr int kMaxDecimals = 9;

/// Texts to the right of the time leave room for this one, so that they keep their places until 100 s.
constexpr double kTwoDigitsS = 10.0;

/// "kinetic 1.25 J, potential −0.75 J", with a unit and decimals that depend on the scale alone.
std::string energy_text(const Energy& energy, double scale_j, Language language) {
    const NumberTitle title = title_of("", "J", scale_j);  // " (kJ)"
    const double scale = scale_j / title.unit;
    const int decimals = scale >= 100.0 ? 0 : scale >= 10.0 ? 1 : 2;
    const auto text = [&](double energy_j) {
        const std::string digits = fmt::format("{:.{}f}", std::abs(energy_j) / title.unit, decimals);
        const bool is_negative = energy_j < 0.0 && digits.find_first_of("123456789") != std::string::npos;
        return (is_negative ? "−" : "") + localized(digits, language) + " " +
               title.text.substr(2, title.text.size() - 3);
    };
    return fmt::format("{} {}, {} {}", translated("kinetic", language), text(energy.kinetic_j),
                       translated("potential", language), text(energy.potential_j()));
}

/// "1/4 speed", "2× speed"
std::string speed_text(Rational speed, Language language) {
    return fmt::format(fmt::runtime(translated("{} speed", language)),
                       speed.text() + (speed.den == 1 ? "×" : ""));
}

/// A text at the lower edge, to the right of the time.
struct BottomText {
    bool (*is_shown)(const OverlayDef& def);
    std::string (*text)(const Caption& caption, double energy_scale_j, Language language);
};
constexpr BottomText kBottomTexts[] = {
    {[](const OverlayDef& def) { return def.energy; },
     [](const Caption& caption, double energy_scale_j, Language language) {
         if (caption.energy_error)
             return localized(translated("energy error", language) + " " + power_text(*caption.energy_error),
                              language);
         return caption.energy ? energy_text(*caption.energy, energy_scale_j, language) : "";
     }},
};

/// Left aligned without padding: the same text at the same place in a film of any duration.
std::string time_text(const Overlay& overlay, double time_s) {
    return time_label(fmt::format("{:.{}f}", time_s, overlay.time_decimals), overlay.area.language);
}

/// Panels above each other have labels of the same width.
std::vector<PlotPanel> make_plots(const TextArea& area, const PlotLayout& layout, const StyleDef& style,
                                  const PixelRect& frame, const OverlayData& data) {
    std::map<int, int> widest_px;  // by the left edge of panels
    const auto panel = [&](std::size_t i) {
        const PixelRect& rect = layout.panels[i];
        return PlotPanel(data.plots[i], {style, frame, rect, layout.em_px, data.body_colors, area.font,
                                         area.words, widest_px[rect.x0], layout.panels.size() > 1});
    };
    const std::size_t count = std::min(layout.panels.size(), data.plots.size());
    for (std::size_t i = 0; i < count; ++i) {
        int& px = widest_px[layout.panels[i].x0];
        px = std::max(px, panel(i).label_px());
    }
    std::vector<PlotPanel> plots;
    for (std::size_t i = 0; i < count; ++i) plots.push_back(panel(i));
    return plots;
}

Insets insets_of(const Overlay& overlay, bool has_color_legend, bool has_arrow_legend) {
    const TextArea& area = overlay.area;
    Insets insets;
    insets.top_px = overlay.heading.bottom_px;
    if (has_color_legend)
        insets.top_px = std::max(insets.top_px, legend_baseline_px(area) + (kDescent + kGap) * area.em_px);
    const bool has_text = std::any_of(std::begin(kBottomTexts), std::end(kBottomTexts),
                                      [&](const BottomText& item) { return item.is_shown(overlay.def); });
    if (overlay.has_time || overlay.has_scale_bar || has_arrow_legend || has_text)
        insets.bottom_px = area.edge_px + (kAscent + kGap) * area.em_px;
    // A tiny frame is for the picture.
    const double half_px = 0.5 * area.height_px;
    const double share = half_px / std::max(half_px, insets.top_px + insets.bottom_px);
    insets.top_px *= share;
    insets.bottom_px *= share;
    return insets;
}

/// Writes a text at the left end of the lower baseline if it ends before `end_px`; returns where the next
/// may begin, with room for the text `widest`.
int write_bottom(const TextArea& area, const std::string& text, int x_px, int end_px, DrawList& list,
                 const std::string& widest = {}) {
    const int width_px = area.font.width_px(text, area.em_px);
    if (x_px + width_px > end_px) return x_px;
    area.font.write({x_px, area.height_px - area.edge_px, area.em_px, area.color, text}, list);
    return x_px + std::max(width_px, area.font.width_px(widest, area.em_px)) + rounded(kLine * area.em_px);
}

void draw_bottom(const Overlay& overlay, const Caption& caption, double pixels_per_metre, DrawList& list) {
    const TextArea& area = overlay.area;
    int left_px = area.edge_px;
    int right_px = area.width_px - area.edge_px;
    if (const auto& legend = overlay.arrow_legend) {
        area.font.write({legend->x_px, area.height_px - area.edge_px, area.em_px, area.color, legend->text},
                        list);
        right_px = legend->x_px - rounded(kLine * area.em_px);
    }
    if (overlay.has_time && caption.time_s)
        left_px = write_bottom(area, time_text(overlay, *caption.time_s), left_px, right_px, list,
                               time_text(overlay, kTwoDigitsS));
    if (overlay.has_scale_bar) right_px = draw_scale_bar(area, pixels_per_metre, left_px, right_px, list);
    if (overlay.has_time && caption.time_s && !overlay.speed.empty())
        left_px = write_bottom(area, overlay.speed, left_px, right_px, list);
    for (const BottomText& item : kBottomTexts) {
        if (item.is_shown(overlay.def) && caption.time_s)
            left_px = write_bottom(area, item.text(caption, overlay.energy_scale_j, area.language), left_px,
                                   right_px, list);
    }
}

}  // namespace

std::vector<std::string> digits_of(std::span<const double> times_s) {
    constexpr int kFewDigits = 3;
    std::vector<std::string> all;
    double steps_1_s = 1.0;  // of the last digit
    for (int digits = 1; digits <= kMaxDecimals; ++digits) {
        all.clear();
        bool is_exact = true;
        steps_1_s *= 10.0;
        for (const double time_s : times_s) {
            all.push_back(fmt::format("{:.{}f}", time_s, digits));
            is_exact &= std::abs(std::round(time_s * steps_1_s) / steps_1_s - time_s) < 1e-9;
        }
        const bool are_apart = std::ranges::adjacent_find(all) == all.end();
        if (is_exact || (digits >= kFewDigits && are_apart)) break;
    }
    return all;
}

std::string time_label(const std::string& digits, Language language) {
    return "t = " + localized(digits, language) + " s";
}

Overlay make_overlay(const OverlayDef& def, const StyleDef& style, int width_px, int height_px,
                     double interval_s, const OverlayData& data) {
    const PlotLayout layout = lay_out_plots(def.plots.size(), width_px, height_px, def.text_px);
    const ThemeColors colors = theme_colors(style);
    const int side_px = std::min(width_px, height_px);
    const int em_px = def.text_px ? rounded(*def.text_px) : em_of(width_px, height_px);
    Overlay overlay{def,
                    {layout.width_px, layout.height_px, side_px, em_px, edge_of(side_px, em_px),
                     text_color(colors), def.language, Font(), Font(def.font)}};
    const TextArea& area = overlay.area;
    const bool by_default = side_px >= kMinSidePx && colors.ground.is_opaque();
    overlay.has_time = def.time.value_or(by_default);
    overlay.has_scale_bar = def.scale_bar.value_or(by_default);
    while (overlay.time_decimals < kMaxDecimals && interval_s * power_of_10(overlay.time_decimals) < 1.0)
        ++overlay.time_decimals;
    overlay.energy_scale_j = data.energy_scale_j;
    if (data.speed != Rational{1, 1}) overlay.speed = speed_text(data.speed, def.language);
    const bool has_legends = def.legend.value_or(by_default);
    const bool has_color_legend = has_legends && quantity_of(style.color_by);
    const bool has_arrow_legend = has_legends && style.arrows != Arrows::kNone;
    if (has_color_legend && data.scale) overlay.color_legend = make_color_legend(area, *data.scale);
    overlay.heading = make_heading(area, def,
                                   overlay.color_legend ? overlay.color_legend->x_px - rounded(kLine * em_px)
                                                        : area.width_px - area.edge_px);
    if (has_arrow_legend) {
        int begin_px = area.edge_px;
        if (overlay.has_time)
            begin_px += area.font.width_px(time_text(overlay, kTwoDigitsS), em_px) + rounded(kLine * em_px);
        overlay.arrow_legend = make_arrow_legend(area, style, data.arrows, begin_px);
    }
    overlay.labels = shortened(area, data.labels);
    overlay.plots = make_plots(area, layout, style, {0, 0, width_px, height_px}, data);
    overlay.insets = insets_of(overlay, has_color_legend, has_arrow_legend);
    overlay.insets.right_panel_px = width_px - layout.width_px;
    overlay.insets.bottom_panel_px = height_px - layout.height_px;
    return overlay;
}

void draw_curves(const Overlay& overlay, double time_s, DrawList& list) {
    for (const PlotPanel& plot : overlay.plots) plot.draw_curves(time_s, list);
    if (overlay.arrow_legend) draw_arrow(overlay.area, *overlay.arrow_legend, list);
}

void draw(const Overlay& overlay, const Caption& caption, double pixels_per_metre, DrawList& list) {
    constexpr std::uint8_t kDim = 0xb0;
    const TextArea& area = overlay.area;
    for (const PlotPanel& plot : overlay.plots) plot.draw_axes(list, area.font, area.words);
    for (std::size_t i = 0; i < caption.labels.size(); ++i)
        draw_label(area, overlay.labels[i], caption.labels[i], list);
    draw_bottom(overlay, caption, pixels_per_metre, list);
    if (overlay.color_legend) draw_legend(area, *overlay.color_legend, list);
    for (const Text& line : overlay.heading.title) area.words.write(line, list);
    for (const OverlayTextDef& text : overlay.def.texts) {
        const double time_s = caption.time_s.value_or(-1.0);
        if (time_s >= text.from_s && time_s < text.to_s.value_or(HUGE_VAL))
            draw_text(area, text, time_s, list);
    }
    if (overlay.def.method)
        area.font.write(
            {area.edge_px,
             overlay.heading.method_baseline_px,
             area.em_px,
             {area.color.r, area.color.g, area.color.b, kDim},
             area.font.shortened(caption.method, area.em_px, overlay.heading.method_room_px, ", ")},
            list);
}

}  // namespace corda::view
