#include "corda/view/plot_panel.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "corda/view/colors.hpp"
#include "corda/view/font.hpp"
#include "corda/view/number_text.hpp"

namespace corda::view {
namespace {

constexpr double kMaxWidthShare = 0.38;  // if the minimum size is larger
constexpr double kMaxHeightShare = 0.5;
constexpr double kPanelShare = 0.36;           // of the frame
constexpr double kHeightPerWidth = 0.8;        // of the box, for a panel at the right
constexpr double kBoxLineWidth = 1.0 / 600.0;  // of the frame's shorter side
constexpr double kCurveWidth = 1.0 / 300.0;
constexpr double kMinCurvePx = 1.5;
constexpr double kDotPerCurve = 3.0;

// Shares of the em.
constexpr double kTickLength = 0.25;
constexpr double kAboveBox = 1.1;  // from the baseline above it
constexpr double kMinBox = 4.0;
constexpr double kMinPanelWidth = 9.5;
constexpr double kMinPanelHeight = 13.0;
constexpr double kPerLabel = 3.0;  // of the height

constexpr int kMinLabels = 2;
constexpr int kMaxLabels = 6;
constexpr std::uint8_t kGridAlpha = 0x2c;
constexpr std::uint8_t kBoxAlpha = 0x90;

/// Points that are closer than this to the last one are left out.
constexpr double kTooClosePx = 0.5;
/// Number of points shown of a curve that is not over time: the last ones.
constexpr std::size_t kMaxPoints = 4000;

struct ValueRange {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    [[nodiscard]] double largest() const { return std::max(std::abs(low), std::abs(high)); }
    /// Widened if it is too narrow to draw: upwards from 0, otherwise about its middle.
    [[nodiscard]] ValueRange widened(double least) const {
        constexpr double kMinShare = 1e-6;
        least = std::max(least, kMinShare * largest());
        if (least == 0.0) least = 1.0;
        if (high - low >= least) return *this;
        if (low >= 0.0 && low < kMinShare * least) return {0.0, least};
        const double middle = 0.5 * (low + high);
        return {middle - 0.5 * least, middle + 0.5 * least};
    }
};

ValueRange range_of(const PlotData& data, double CurvePoint::*value) {
    ValueRange range;
    for (const PlotData::Curve& curve : data.curves)
        for (const CurvePoint& point : curve.points) range.include(point.*value);
    return range;
}

/// True if an axis of that extent has steps.
bool can_be_divided(double extent) {
    constexpr double kMinExtent = 1e-290;
    return extent >= kMinExtent && extent <= 1.0 / kMinExtent;
}

/// The distance of labels that gives at most `most_steps` steps.
RoundNumber step_of(double extent, int most_steps) {
    return round_number_above(extent / most_steps);
}

/// Keeps the first, highest, lowest and last point in each column of pixels; the picture is the same.
void keep_outline(std::vector<PixelPoint>& points, std::vector<double>& times_s) {
    std::size_t kept = 0;
    for (std::size_t first = 0; first < points.size();) {
        const double column = std::floor(points[first].x);
        std::size_t end = first;
        std::size_t low = first;
        std::size_t high = first;
        for (; end < points.size() && std::floor(points[end].x) == column; ++end) {
            if (points[end].y < points[low].y) low = end;
            if (points[end].y > points[high].y) high = end;
        }
        std::size_t last = points.size();
        for (const std::size_t i : {first, std::min(low, high), std::max(low, high), end - 1}) {
            if (i == last) continue;
            last = i;
            points[kept] = points[i];
            times_s[kept++] = times_s[i];
        }
        first = end;
    }
    points.resize(kept);
    times_s.resize(kept);
}

void keep_apart(std::vector<PixelPoint>& points, std::vector<double>& times_s) {
    std::size_t kept = 1;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const PixelPoint& last = points[kept - 1];
        if (std::abs(points[i].x - last.x) < kTooClosePx && std::abs(points[i].y - last.y) < kTooClosePx)
            continue;
        points[kept] = points[i];
        times_s[kept++] = times_s[i];
    }
    points.resize(kept);
    times_s.resize(kept);
}

Color faint(Color color, std::uint8_t alpha) {
    return {color.r, color.g, color.b, alpha};
}

}  // namespace

Room room_beside(LivePlot plot, int width_px, int height_px) {
    const bool is_beside = width_px > height_px;
    const int all_px = std::max(width_px, height_px);
    const double least_em = is_beside ? kMinPanelWidth : kMinPanelHeight;
    const int least_px = rounded(least_em * em_of(std::min(width_px, height_px)));
    const int panel_px = std::max(rounded(kPanelShare * all_px), least_px);
    const bool has_room = panel_px <= (is_beside ? kMaxWidthShare : kMaxHeightShare) * all_px;
    if (plot == LivePlot::kNone || !has_room) return {width_px, height_px};
    if (is_beside) return {width_px - panel_px, height_px};
    return {width_px, height_px - panel_px};
}

PlotPanel::PlotPanel(const StyleDef& style, int width_px, int height_px)
    : width_px_(width_px),
      height_px_(height_px),
      is_beside_(width_px > height_px),
      em_px_(em_of(std::min(width_px, height_px))),
      edge_px_(edge_of(std::min(width_px, height_px), em_px_)) {
    const int side_px = std::min(width_px, height_px);
    line_px_ = std::max(1, rounded(kBoxLineWidth * side_px));
    text_color_ = text_color(look_of(style));
    // The theme's: those of a style are for its bodies.
    StyleDef plain;
    plain.theme = style.theme;
    palette_ = look_of(plain).palette;
}

std::vector<Color> PlotPanel::choose_colors(const PlotData& data, std::span<const Color> body_colors) const {
    std::vector<Color> colors;
    const auto add = [&](Color color) {
        if (std::find(colors.begin(), colors.end(), color) == colors.end()) colors.push_back(color);
    };
    if (data.body) add(body_colors[*data.body]);
    if (data.body) add(text_color_);
    const auto is_free = [&](Color color) {
        return color != text_color_ &&
               std::find(body_colors.begin(), body_colors.end(), color) == body_colors.end();
    };
    std::copy_if(palette_.begin(), palette_.end(), std::back_inserter(colors), is_free);
    for (const Color color : palette_) add(color);
    if (!data.body && data.curves.size() > 2) colors[2] = text_color_;
    return colors;
}

void PlotPanel::set_data(const PlotData& data, std::span<const Color> body_colors, Font& font) {
    const Room room = room_beside(LivePlot::kEnergy, width_px_, height_px_);
    const PixelRect panel{is_beside_ ? room.width_px : 0, is_beside_ ? 0 : room.height_px, width_px_,
                          height_px_};
    const bool is_over_time = data.end_s > 0.0;
    const auto start_axis = [](const PlotData::AxisName& name, const ValueRange& range) {
        const NumberTitle title = title_of(name.text, name.unit, range.largest());
        Axis axis;
        axis.low = range.low;
        axis.high = range.high;
        axis.title = title.text;
        axis.unit = title.unit;
        return axis;
    };
    x_ = start_axis(data.x, is_over_time ? ValueRange{0.0, data.end_s}
                                         : range_of(data, &CurvePoint::x).widened(data.x.least_extent));
    y_ = start_axis(data.y, range_of(data, &CurvePoint::y).widened(data.y.least_extent));
    curves_.clear();
    const std::vector<Color> colors = choose_colors(data, body_colors);
    for (std::size_t i = 0; i < data.curves.size(); ++i)
        curves_.push_back({data.curves[i].name, colors[i], {}, {}, data.curves[i].points});
    place_names(panel, font);
    is_shown_ = !panel.empty() && can_be_divided(x_.high - x_.low) && can_be_divided(y_.high - y_.low) &&
                place_box(panel, is_over_time, font);
    if (!is_shown_) return;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
        PixelCurve& curve = curves_[i];
        for (const CurvePoint& point : data.curves[i].points) {
            curve.points.push_back({x_.px(point.x), y_.px(point.y)});
            curve.times_s.push_back(point.time_s);
        }
        if (is_over_time)
            keep_outline(curve.points, curve.times_s);
        else
            keep_apart(curve.points, curve.times_s);
    }
}

void PlotPanel::place_names(const PixelRect& panel, Font& font) {
    names_.clear();
    name_rows_ = 0;
    const int begin_px = panel.x0 + edge_px_;
    const int end_px = panel.x1 - edge_px_;
    int x_px = begin_px;
    for (const PixelCurve& curve : curves_) {
        if (curve.name.empty()) continue;
        const int name_px = font.width_px(curve.name, em_px_);
        if (x_px > begin_px && x_px + name_px > end_px) {
            x_px = begin_px;
            ++name_rows_;
        }
        names_.push_back({curve.name, curve.color, x_px, name_rows_});
        x_px += name_px + em_px_;
    }
    if (!names_.empty()) ++name_rows_;
}

bool PlotPanel::place_box(const PixelRect& panel, bool is_over_time, Font& font) {
    const int line_px = rounded(kLine * em_px_);
    const int gap_px = rounded(kGap * em_px_);
    const int above_px = name_rows_ * line_px + rounded((kAscent + kAboveBox) * em_px_);
    const int below_px = rounded(kTickLength * em_px_) + 2 * line_px;
    const int top_px = is_beside_ ? edge_px_ : gap_px;
    const int all_px = panel.height() - top_px - edge_px_ - above_px - below_px;
    const int most_px = is_beside_ ? rounded(kHeightPerWidth * panel.width()) : all_px;
    const int height_px = std::min(all_px, most_px);
    const int least_px = rounded(kMinBox * em_px_);
    if (height_px < least_px) return false;
    box_.y0 = panel.y0 + top_px + (all_px - height_px) / 2 + above_px;
    box_.y1 = box_.y0 + height_px;
    y_.low_px = box_.y1 - 1;
    y_.high_px = box_.y0;
    const int y_labels = std::clamp(rounded(height_px / (kPerLabel * em_px_)), kMinLabels, kMaxLabels);
    const RoundNumber y_step = step_of(y_.high - y_.low, y_labels);
    y_.low = y_step.times(std::floor(y_.low / y_step.value()));
    y_.high = y_step.times(std::ceil(y_.high / y_step.value()));
    add_labels(y_, y_labels + 1);
    int widest_px = 0;
    for (const Label& label : y_.labels) widest_px = std::max(widest_px, font.width_px(label.text, em_px_));
    box_.x0 = panel.x0 + edge_px_ + widest_px + gap_px + rounded(kTickLength * em_px_);
    // Half of the last label on the x axis.
    box_.x1 = panel.x1 - edge_px_ - em_px_;
    if (box_.width() < least_px) return false;
    x_.low_px = box_.x0;
    x_.high_px = box_.x1 - 1;
    if (!is_over_time) {
        const RoundNumber step = step_of(x_.high - x_.low, kMaxLabels);
        x_.low = step.times(std::floor(x_.low / step.value()));
        x_.high = step.times(std::ceil(x_.high / step.value()));
    }
    for (int most = kMaxLabels; most >= 1; --most) {
        add_labels(x_, most);
        int end_px = std::numeric_limits<int>::min();
        bool fits = true;
        for (const Label& label : x_.labels) {
            const int half_px = (font.width_px(label.text, em_px_) + 1) / 2;
            fits &= label.at_px - half_px >= end_px;
            end_px = label.at_px + half_px + gap_px;
        }
        if (fits) break;
    }
    return true;
}

void PlotPanel::add_labels(Axis& axis, int most) const {
    axis.labels.clear();
    constexpr double kSlack = 1e-9;
    constexpr int kMinDigits = 6;
    constexpr int kMaxDigits = 15;
    const RoundNumber step = step_of(axis.high - axis.low, most);
    // Far from 0 it takes more digits to tell neighbours apart.
    int digits = kMinDigits;
    const double steps = std::max(std::abs(axis.low), std::abs(axis.high)) / step.value();
    while (digits < kMaxDigits && power_of_10(digits - 1) < steps) ++digits;
    const auto first = static_cast<std::int64_t>(std::ceil(axis.low / step.value() - kSlack));
    const auto last = static_cast<std::int64_t>(std::floor(axis.high / step.value() + kSlack));
    for (std::int64_t k = first; k <= last; ++k) {
        const double value = step.times(static_cast<double>(k));
        axis.labels.push_back({display_number(value / axis.unit, digits), rounded(axis.px(value))});
    }
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
    const double half_px = 0.5 * line_px_;
    for (const Label& label : x_.labels)
        list.add_capsule({label.at_px + half_px, box_.y0 + half_px},
                         {label.at_px + half_px, box_.y1 - half_px}, half_px);
    for (const Label& label : y_.labels)
        list.add_capsule({box_.x0 + half_px, label.at_px + half_px},
                         {box_.x1 - half_px, label.at_px + half_px}, half_px);
    const double radius_px = 0.5 * std::max(kMinCurvePx, kCurveWidth * std::min(width_px_, height_px_));
    for (std::size_t i = curves_.size(); i-- > 0;) {
        const PixelCurve& curve = curves_[i];
        list.add_layer(curve.color);
        list.layers.back().is_note = true;
        const CurvePoint now = curve.at(time_s);
        const auto later = std::lower_bound(curve.times_s.begin(), curve.times_s.end(), now.time_s);
        const auto end = static_cast<std::size_t>(later - curve.times_s.begin());
        const PixelPoint dot{x_.px(now.x), y_.px(now.y)};
        for (std::size_t k = end - std::min(end, kMaxPoints); k < end; ++k)
            list.add_capsule(curve.points[k], k + 1 < end ? curve.points[k + 1] : dot, radius_px);
        list.add_capsule(dot, dot, kDotPerCurve * radius_px);
    }
}

void PlotPanel::write(const std::string& text, int x_px, int y_px, Color color, DrawList& list,
                      Font& font) const {
    font.write({x_px, y_px, em_px_, color, text}, list);
}

void PlotPanel::draw_axes(DrawList& list, Font& font) const {
    if (!is_shown_) return;
    const Color line = faint(text_color_, kBoxAlpha);
    const int tick_px = rounded(kTickLength * em_px_);
    const int gap_px = rounded(kGap * em_px_);
    const int row_px = rounded(kLine * em_px_);
    list.add_box({box_.x0, box_.y0, box_.x0 + line_px_, box_.y1}, line);
    list.add_box({box_.x0 + line_px_, box_.y1 - line_px_, box_.x1, box_.y1}, line);
    const auto width_px = [&](const std::string& text) { return font.width_px(text, em_px_); };
    for (const Label& label : y_.labels) {
        list.add_box({box_.x0 - tick_px, label.at_px, box_.x0, label.at_px + line_px_}, line);
        write(label.text, box_.x0 - tick_px - gap_px - width_px(label.text),
              label.at_px + rounded(0.5 * kAscent * em_px_), text_color_, list, font);
    }
    const int labels_px = box_.y1 + tick_px + row_px;
    for (const Label& label : x_.labels) {
        list.add_box({label.at_px, box_.y1, label.at_px + line_px_, box_.y1 + tick_px}, line);
        write(label.text, label.at_px - width_px(label.text) / 2, labels_px, text_color_, list, font);
    }
    write(x_.title, (box_.x0 + box_.x1 - width_px(x_.title)) / 2, labels_px + row_px, text_color_, list,
          font);
    const int title_px = box_.y0 - name_rows_ * row_px - rounded(kAboveBox * em_px_);
    write(y_.title, names_.empty() ? box_.x0 : names_.front().x_px, title_px, text_color_, list, font);
    for (const Name& name : names_)
        write(name.text, name.x_px, title_px + (name.row + 1) * row_px, name.color, list, font);
}

}  // namespace corda::view
