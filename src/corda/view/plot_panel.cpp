#include "corda/view/plot_panel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/view/colors.hpp"
#include "corda/view/font.hpp"
#include "corda/view/number_text.hpp"

namespace corda::view {
namespace {

constexpr double kMaxWidthShare = 0.38;  // if the minimum size is larger
constexpr double kMaxHeightShare = 0.5;
constexpr double kPanelShare = 0.36;  // of the frame
// The texts of several plots are smaller down to these shares, in one column or row, or in two.
constexpr double kSmall = 0.75;
constexpr double kSmallest = 0.45;
constexpr int kMinEmPx = 7;
constexpr double kHeightPerWidth = 0.8;        // of the box, for a panel at the right
constexpr double kBoxLineWidth = 1.0 / 600.0;  // of the frame's shorter side
constexpr double kCurveWidth = 1.0 / 300.0;
constexpr double kMinCurvePx = 1.5;
constexpr double kDotPerCurve = 3.0;

// Shares of the em.
constexpr double kAboveBox = 1.1;  // from the baseline above it
constexpr double kMinBox = 4.0;
constexpr double kMinPanelWidth = 9.5;
constexpr double kMinPanelHeight = 13.0;
constexpr double kMinRowWidth = 12.0;  // of panels in a row below the picture
constexpr double kTight = 0.85;        // of the height in a column, for the smallest texts
constexpr int kMaxNameRows = 3;
constexpr double kSmallestName = 0.6;  // of the em
constexpr double kPerLabel = 3.0;      // of the height

constexpr int kMinLabels = 2;
constexpr int kMaxLabels = 6;
constexpr std::uint8_t kGridAlpha = 0x2c;
constexpr std::uint8_t kBoxAlpha = 0x90;

/// Number of points shown of a curve that is not over time: the last ones.
constexpr std::size_t kMaxPoints = 4000;

/// Widened if it is too narrow to draw: upwards from 0, otherwise about its middle.
ValueRange drawable(const ValueRange& range, double least) {
    constexpr double kMinShare = 1e-6;
    least = std::max(least, kMinShare * range.largest());
    if (least == 0.0) least = 1.0;
    if (range.low >= 0.0 && range.low < kMinShare * least && range.extent() < least) return {0.0, least};
    return range.widened(least);
}

ValueRange range_of(const PlotData& data, double CurvePoint::*value) {
    ValueRange range;
    for (const PlotData::Curve& curve : data.curves)
        for (const CurvePoint& point : curve.points) range.include(point.*value);
    return range;
}

bool is_gap(const PixelPoint& point) {
    return std::isnan(point.y);
}

Color faint(Color color, std::uint8_t alpha) {
    return {color.r, color.g, color.b, alpha};
}

}  // namespace

PlotLayout lay_out_plots(std::size_t count, int width_px, int height_px, std::optional<double> text_px) {
    const bool is_beside = width_px > height_px;
    const int em_px = em_of(width_px, height_px);
    const int all_px = std::max(width_px, height_px);   // along which the picture makes room
    const int side_px = std::min(width_px, height_px);  // along which panels stand in line
    const double least_em = is_beside ? kMinPanelWidth : kMinPanelHeight;
    const double least_side_em = is_beside ? kMinPanelHeight : kMinRowWidth;
    const auto lay_out = [&](int shown, int lines, double smallest) {
        const int per_line = (shown + lines - 1) / lines;
        const int room_px = lines == 1 ? rounded(kPanelShare * all_px) : all_px / 2;
        const double tight = is_beside && smallest == kSmallest ? kTight : 1.0;
        int own_em_px = text_px ? rounded(*text_px) : em_px;
        if (shown > 1 || text_px)
            own_em_px =
                std::min(own_em_px, static_cast<int>(std::min(room_px / (lines * least_em),
                                                              side_px / (per_line * tight * least_side_em))));
        const int taken_px = std::max(room_px, rounded(lines * least_em * own_em_px));
        const double most = is_beside && lines == 1 ? kMaxWidthShare : kMaxHeightShare;
        PlotLayout layout{width_px, height_px};
        if (taken_px > most * all_px || own_em_px < std::max<double>(smallest * em_px, kMinEmPx))
            return layout;
        layout.em_px = own_em_px;
        (is_beside ? layout.width_px : layout.height_px) -= taken_px;
        for (int i = 0; i < shown; ++i) {
            const int line = i / per_line;
            const int in_line = std::min(per_line, shown - line * per_line);
            const int begin_px = all_px - taken_px + line * taken_px / lines;
            const int end_px = all_px - taken_px + (line + 1) * taken_px / lines;
            const int from_px = i % per_line * side_px / in_line;
            const int to_px = (i % per_line + 1) * side_px / in_line;
            layout.panels.push_back(is_beside ? PixelRect{begin_px, from_px, end_px, to_px}
                                              : PixelRect{from_px, begin_px, to_px, end_px});
        }
        return layout;
    };
    for (auto shown = static_cast<int>(count); shown > 0; --shown) {
        for (const auto& [lines, smallest] :
             {std::pair{1, kSmall}, {2, kSmall}, {is_beside ? 1 : 2, kSmallest}}) {
            if (shown <= lines && lines > 1) continue;
            PlotLayout layout = lay_out(shown, lines, smallest);
            if (!layout.panels.empty()) return layout;
        }
    }
    return {width_px, height_px};
}

PlotPanel::PlotPanel(const PlotData& data, const PlotPlace& place)
    : width_px_(place.frame.width()),
      height_px_(place.frame.height()),
      panel_(place.panel),
      edge_px_(edge_of(std::min(width_px_, height_px_), place.em_px)),
      text_color_(text_color(theme_colors(place.style))) {
    plot_.em_px = place.em_px;
    plot_.line_px = std::max(1, rounded(kBoxLineWidth * std::min(width_px_, height_px_)));
    start_axes(data, place.font);
    // The theme's: those of a style are for its bodies.
    StyleDef plain;
    plain.theme = place.style.theme;
    const std::vector<Color> palette = theme_colors(plain).palette;
    for (const PlotData::Curve& curve : data.curves) {
        const auto hue = static_cast<std::size_t>(curve.hue);
        Color color = hue == 0 ? text_color_ : palette[hue];
        if (curve.body) {
            // Bodies whose colours tell a quantity all have the same.
            const Color own = place.body_colors[*curve.body];
            const bool is_alone = std::ranges::count_if(data.curves, [&](const PlotData::Curve& other) {
                                      return place.body_colors[*other.body] == own;
                                  }) == 1;
            color = is_alone ? own : palette[*curve.body % palette.size()];
        }
        curves_.push_back({curve.name, color, {}, {}, curve.points});
    }
    place_names(place.words, place.is_one_of_several);
    const bool is_drawable = can_be_divided(plot_.x.high - plot_.x.low) &&
                             (data.y.is_log || can_be_divided(plot_.y.high - plot_.y.low));
    has_room_ = !is_drawable || place_box(data.end_s > 0.0, place.least_label_px, place.font);
    is_shown_ = is_drawable && has_room_;
    if (!is_shown_) return;
    for (PixelCurve& curve : curves_) place_points(curve);
}

void PlotPanel::start_axes(const PlotData& data, const Font& font) {
    const auto start_axis = [&](const PlotData::AxisName& name, ValueRange range) {
        PlotAxis axis;
        axis.is_given = name.range.has_value();
        if (axis.is_given) range = {name.range->low, name.range->high};
        axis.language = data.language;
        axis.is_log = name.is_log;
        axis.low = name.is_log ? log10_of(range.low) : range.low;
        axis.high = name.is_log ? log10_of(range.high) : range.high;
        const double largest = name.is_log ? 0.0 : range.largest();
        NumberTitle title = title_of(name.text, name.unit, largest);
        if (!name.symbol.empty() && font.width_px(title.text, plot_.em_px) > panel_.width() - 2 * edge_px_)
            title = title_of(name.symbol, name.unit, largest);
        axis.title = title.text;
        axis.unit = title.unit;
        return axis;
    };
    plot_.x =
        start_axis(data.x, data.end_s > 0.0 ? ValueRange{0.0, data.end_s}
                                            : drawable(range_of(data, &CurvePoint::x), data.x.least_extent));
    const ValueRange y = range_of(data, &CurvePoint::y);
    plot_.y = start_axis(data.y, data.y.is_log ? y : drawable(y, data.y.least_extent));
}

void PlotPanel::place_points(PixelCurve& curve) const {
    std::vector<PixelPoint> points;  // up to a gap
    const auto add_points = [&](std::size_t end) {
        for (const std::size_t k : visible_points(points)) {
            curve.points.push_back(points[k]);
            curve.times_s.push_back(curve.samples[end - points.size() + k].time_s);
        }
        points.clear();
    };
    for (std::size_t k = 0; k < curve.samples.size(); ++k) {
        const CurvePoint& point = curve.samples[k];
        const PixelPoint at{plot_.x.px(point.x), plot_.y.px(point.y)};
        if (is_gap(at) && !points.empty()) {
            add_points(k);
            curve.points.push_back(at);
            curve.times_s.push_back(point.time_s);
        }
        if (!is_gap(at)) points.push_back(at);
    }
    if (!points.empty()) add_points(curve.samples.size());
}

std::vector<std::string> PlotPanel::nameless() const {
    std::vector<std::string> names;
    for (const PixelCurve& curve : curves_)
        if (!curve.name.empty()) names.push_back(curve.name);
    names.erase(names.begin(), names.begin() + std::ssize(names_));  // names are left out from the end
    return names;
}

void PlotPanel::place_names(const Font& font, bool is_one_of_several) {
    const int least_px = std::max(kMinEmPx, rounded(kSmallestName * plot_.em_px));
    for (const int most_rows : {1, kMaxNameRows}) {
        if (most_rows == 1 && !is_one_of_several) continue;
        for (name_em_px_ = plot_.em_px; name_em_px_ >= least_px; --name_em_px_)
            if (add_names(font, most_rows) && room_px() >= rounded(kMinBox * plot_.em_px)) return;
    }
    name_em_px_ = plot_.em_px;
    static_cast<void>(add_names(font, kMaxNameRows));
}

bool PlotPanel::add_names(const Font& font, int most_rows) {
    names_.clear();
    name_rows_ = 0;
    const int begin_px = panel_.x0 + edge_px_;
    const int end_px = panel_.x1 - edge_px_;
    int x_px = begin_px;
    for (const PixelCurve& curve : curves_) {
        if (curve.name.empty()) continue;
        const std::string text = font.shortened(curve.name, name_em_px_, end_px - begin_px);
        const int name_px = font.width_px(text, name_em_px_);
        if (x_px > begin_px && x_px + name_px > end_px) {
            x_px = begin_px;
            if (++name_rows_ == most_rows) return false;
        }
        names_.push_back({text, curve.color, x_px, name_rows_});
        x_px += name_px + name_em_px_;
    }
    if (!names_.empty()) ++name_rows_;
    return true;
}

int PlotPanel::room_px() const {
    const int gap_px = rounded(kGap * plot_.em_px);
    const int top_px = panel_.y0 == 0 ? edge_px_ : gap_px;
    const int bottom_px = panel_.y1 == height_px_ ? edge_px_ : gap_px;
    return panel_.height() - top_px - bottom_px - above_px() - plot_.title_px();
}

int PlotPanel::above_px() const {
    return name_rows_ * rounded(kLine * name_em_px_) + rounded((kAscent + kAboveBox) * plot_.em_px);
}

bool PlotPanel::place_box(bool is_over_time, int least_label_px, const Font& font) {
    const int gap_px = rounded(kGap * plot_.em_px);
    const int least_px = rounded(kMinBox * plot_.em_px);
    const int top_px = panel_.y0 == 0 ? edge_px_ : gap_px;
    for (; name_rows_ > 0 && room_px() < least_px; --name_rows_)
        std::erase_if(names_, [this](const Name& name) { return name.row == name_rows_ - 1; });
    const int all_px = room_px();
    if (all_px < least_px) return false;
    const int most_px = width_px_ > height_px_ ? rounded(kHeightPerWidth * panel_.width()) : all_px;
    const int height_px = std::min(all_px, most_px);
    plot_.box.y0 = panel_.y0 + top_px + (all_px - height_px) / 2 + above_px();
    plot_.box.y1 = plot_.box.y0 + height_px;
    plot_.y.low_px = plot_.box.y1 - 1;
    plot_.y.high_px = plot_.box.y0;
    const int y_labels = std::clamp(rounded(height_px / (kPerLabel * plot_.em_px)), kMinLabels, kMaxLabels);
    plot_.y.extend_to_labels(y_labels);
    plot_.y.set_labels(y_labels + 1);
    label_px_ = least_label_px;
    for (const PlotAxis::Label& label : plot_.y.labels)
        label_px_ = std::max(label_px_, font.width_px(label.text, plot_.em_px));
    plot_.box.x0 = panel_.x0 + edge_px_ + label_px_ + gap_px + rounded(kTickLength * plot_.em_px);
    // Half of the last label on the x axis.
    plot_.box.x1 = panel_.x1 - edge_px_ - plot_.em_px;
    if (plot_.box.width() < least_px) return false;
    plot_.x.low_px = plot_.box.x0;
    plot_.x.high_px = plot_.box.x1 - 1;
    if (!is_over_time) plot_.x.extend_to_labels(kMaxLabels);
    plot_.x.set_labels_apart(kMaxLabels, gap_px, plot_.em_px, font);
    return true;
}

CurvePoint PlotPanel::PixelCurve::at(double time_s) const {
    const auto is_before = [](const CurvePoint& point, double time) { return point.time_s < time; };
    const auto after = std::lower_bound(samples.begin(), samples.end(), time_s, is_before);
    if (after == samples.end()) return samples.back();
    if (after == samples.begin() || after->time_s == time_s) return *after;
    const CurvePoint& last = *(after - 1);
    const double share = (time_s - last.time_s) / (after->time_s - last.time_s);
    return {time_s, last.x + share * (after->x - last.x), last.y + share * (after->y - last.y)};
}

void PlotPanel::draw_curves(double time_s, DrawList& list) const {
    if (!is_shown_) return;
    list.add_layer(faint(text_color_, kGridAlpha));
    list.layers.back().is_note = true;
    plot_.add_grid(list);
    const double radius_px = 0.5 * std::max(kMinCurvePx, kCurveWidth * std::min(width_px_, height_px_));
    for (std::size_t i = curves_.size(); i-- > 0;) {
        const PixelCurve& curve = curves_[i];
        list.add_layer(curve.color);
        list.layers.back().is_note = true;
        const CurvePoint now = curve.at(time_s);
        const auto later = std::lower_bound(curve.times_s.begin(), curve.times_s.end(), now.time_s);
        const auto end = static_cast<std::size_t>(later - curve.times_s.begin());
        const PixelPoint dot{plot_.x.px(now.x), plot_.y.px(now.y)};
        for (std::size_t k = end - std::min(end, kMaxPoints); k < end; ++k) {
            const PixelPoint& next = k + 1 < end ? curve.points[k + 1] : dot;
            if (!is_gap(curve.points[k]) && !is_gap(next))
                add_clipped(curve.points[k], next, radius_px, list);
        }
        if (!is_gap(dot)) add_clipped(dot, dot, kDotPerCurve * radius_px, list);
    }
}

void PlotPanel::add_clipped(PixelPoint a, PixelPoint b, double radius_px, DrawList& list) const {
    // By Liang and Barsky, one pair of sides at a time: the part from share `from` to `to`.
    double from = 0.0;
    double to = 1.0;
    const auto clip = [&](double at, double way, double low, double high) {
        if (way == 0.0) {
            if (at < low || at > high) to = -1.0;
            return;
        }
        const auto [first, last] = std::minmax({(low - at) / way, (high - at) / way});
        from = std::max(from, first);
        to = std::min(to, last);
    };
    const PixelPoint way{b.x - a.x, b.y - a.y};
    if (plot_.x.is_given) clip(a.x, way.x, plot_.box.x0, plot_.box.x1);
    if (plot_.y.is_given) clip(a.y, way.y, plot_.box.y0, plot_.box.y1);
    if (from > to) return;
    if (to < 1.0) b = {a.x + to * way.x, a.y + to * way.y};
    if (from > 0.0) a = {a.x + from * way.x, a.y + from * way.y};
    list.add_capsule(a, b, radius_px);
}

void PlotPanel::draw_axes(DrawList& list, const Font& font, const Font& words) const {
    if (!is_shown_) return;
    plot_.draw_axes(faint(text_color_, kBoxAlpha), text_color_, list, font);
    const int row_px = rounded(kLine * name_em_px_);
    const int title_px = plot_.box.y0 - name_rows_ * row_px - rounded(kAboveBox * plot_.em_px);
    const int last_px = panel_.x1 - edge_px_ - font.width_px(plot_.y.title, plot_.em_px);
    const int title_x_px = names_.empty() ? std::min(plot_.box.x0, last_px) : names_.front().x_px;
    font.write({title_x_px, title_px, plot_.em_px, text_color_, plot_.y.title}, list);
    for (const Name& name : names_)
        words.write({name.x_px, title_px + (name.row + 1) * row_px, name_em_px_, name.color, name.text},
                    list);
}

}  // namespace corda::view
