#include "corda/view/plot_axis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda::view {
namespace {

/// Points that are closer than this to the last one are left out.
constexpr double kTooClosePx = 0.5;

/// The distance of labels that gives at most `most_steps` steps.
RoundNumber step_of(double extent, int most_steps) {
    return round_number_above(extent / most_steps);
}

/// The distance of labels that gives at most `most` steps, and labels at both ends if a number of two digits
/// does.
RoundNumber step_between(double low, double high, int most) {
    constexpr double kSlack = 1e-9;
    const auto is_whole = [](double number) { return std::abs(number - std::round(number)) < kSlack; };
    const RoundNumber usual = step_of(high - low, most);
    if (is_whole(low / usual.value()) && is_whole(high / usual.value())) return usual;
    for (int steps = most; steps > 0; --steps) {
        const double step = (high - low) / steps;
        const int exponent = round_number_below(step).exponent - 1;
        const double digits = step / power_of_10(exponent);
        if (is_whole(digits) && is_whole(low / step)) return {static_cast<int>(std::round(digits)), exponent};
    }
    return usual;
}

std::vector<std::size_t> outline(const std::vector<PixelPoint>& points) {
    std::vector<std::size_t> kept;
    for (std::size_t first = 0; first < points.size();) {
        const double column = std::floor(points[first].x);
        std::size_t end = first;
        std::size_t low = first;
        std::size_t high = first;
        for (; end < points.size() && std::floor(points[end].x) == column; ++end) {
            if (points[end].y < points[low].y) low = end;
            if (points[end].y > points[high].y) high = end;
        }
        for (const std::size_t i : {first, std::min(low, high), std::max(low, high), end - 1})
            if (kept.empty() || kept.back() != i) kept.push_back(i);
        first = end;
    }
    return kept;
}

/// Places of 2, 3, ... 9 times each power of 10.
std::vector<int> minor_ticks(const PlotAxis& axis) {
    constexpr double kMaxDecades = 8.0;
    std::vector<int> ticks;
    if (!axis.is_log || axis.high - axis.low > kMaxDecades) return ticks;
    for (double decade = axis.low; decade < axis.high; ++decade)
        for (int k = 2; k < 10; ++k) ticks.push_back(rounded(axis.px(k * std::pow(10.0, decade))));
    return ticks;
}

}  // namespace

double PlotAxis::px(double value) const {
    const double at = is_log ? log10_of(value) : value;
    return low_px + (at - low) / (high - low) * (high_px - low_px);
}

void PlotAxis::extend_to_labels(int most_steps) {
    if (is_log) {
        low = std::floor(low);
        high = std::max(std::ceil(high), low + 1.0);
        return;
    }
    if (is_given) return;
    constexpr double kSlack =
        0.01;  // less than a pixel, so that a swing from 40 degrees ends at -40, not -60
    const RoundNumber step = step_of(high - low, most_steps);
    low = step.times(std::floor(low / step.value() + kSlack));
    high = step.times(std::ceil(high / step.value() - kSlack));
}

void PlotAxis::set_labels(int most) {
    labels.clear();
    constexpr double kSlack = 1e-9;
    constexpr int kMinDigits = 6;
    constexpr int kMaxDigits = 15;
    const RoundNumber step = is_log
                                 ? RoundNumber{std::max(1, static_cast<int>(std::ceil((high - low) / most)))}
                             : is_given ? step_between(low, high, most)
                                        : step_of(high - low, most);
    // Far from 0 it takes more digits to tell neighbours apart.
    int digits = kMinDigits;
    const double steps = std::max(std::abs(low), std::abs(high)) / step.value();
    while (digits < kMaxDigits && power_of_10(digits - 1) < steps) ++digits;
    const auto first = static_cast<std::int64_t>(std::ceil(low / step.value() - kSlack));
    const auto last = static_cast<std::int64_t>(std::floor(high / step.value() + kSlack));
    for (std::int64_t k = first; k <= last; ++k) {
        const double value = step.times(static_cast<double>(k));
        const double at_px = low_px + (value - low) / (high - low) * (high_px - low_px);
        labels.push_back({is_log ? power_of_10_text(static_cast<int>(value))
                                 : localized(display_number(value / unit, digits), language),
                          rounded(at_px)});
    }
}

void PlotAxis::set_labels_apart(int most, int gap_px, int em_px, const Font& font) {
    bool fits = false;
    for (; !fits && most >= 1; --most) {
        set_labels(most);
        int end_px = std::numeric_limits<int>::min();
        fits = true;
        for (const Label& label : labels) {
            const int half_px = (font.width_px(label.text, em_px) + 1) / 2;
            fits &= label.at_px - half_px >= end_px;
            end_px = label.at_px + half_px + gap_px;
        }
    }
}

int PlotBox::title_px() const {
    return rounded(kTickLength * em_px) + 2 * rounded(kLine * em_px);
}

void PlotBox::add_grid(DrawList& list) const {
    const double half_px = 0.5 * line_px;
    for (const PlotAxis::Label& label : x.labels)
        list.add_capsule({label.at_px + half_px, box.y0 + half_px}, {label.at_px + half_px, box.y1 - half_px},
                         half_px);
    for (const PlotAxis::Label& label : y.labels)
        list.add_capsule({box.x0 + half_px, label.at_px + half_px}, {box.x1 - half_px, label.at_px + half_px},
                         half_px);
}

void PlotBox::draw_axes(Color line, Color text, DrawList& list, const Font& font) const {
    const int tick_px = rounded(kTickLength * em_px);
    const int gap_px = rounded(kGap * em_px);
    const auto width_px = [&](const std::string& of) { return font.width_px(of, em_px); };
    const auto write = [&](const std::string& utf8, int x_px, int y_px) {
        font.write({x_px, y_px, em_px, text, utf8}, list);
    };
    list.add_box({box.x0, box.y0, box.x0 + line_px, box.y1}, line);
    list.add_box({box.x0 + line_px, box.y1 - line_px, box.x1, box.y1}, line);
    for (const PlotAxis::Label& label : y.labels) {
        list.add_box({box.x0 - tick_px, label.at_px, box.x0, label.at_px + line_px}, line);
        write(label.text, box.x0 - tick_px - gap_px - width_px(label.text),
              label.at_px + rounded(0.5 * kAscent * em_px));
    }
    const int title_y_px = box.y1 + title_px();
    for (const PlotAxis::Label& label : x.labels) {
        list.add_box({label.at_px, box.y1, label.at_px + line_px, box.y1 + tick_px}, line);
        write(label.text, label.at_px - width_px(label.text) / 2, title_y_px - rounded(kLine * em_px));
    }
    write(x.title, (box.x0 + box.x1 - width_px(x.title)) / 2, title_y_px);
    for (const int at_px : minor_ticks(x))
        list.add_box({at_px, box.y1, at_px + line_px, box.y1 + tick_px / 2}, line);
    for (const int at_px : minor_ticks(y))
        list.add_box({box.x0 - tick_px / 2, at_px, box.x0, at_px + line_px}, line);
}

bool can_be_divided(double extent) {
    constexpr double kMinExtent = 1e-290;
    return extent >= kMinExtent && extent <= 1.0 / kMinExtent;
}

std::vector<std::size_t> visible_points(const std::vector<PixelPoint>& points) {
    if (std::ranges::is_sorted(points, {}, &PixelPoint::x)) return outline(points);
    std::vector<std::size_t> kept{0};
    for (std::size_t i = 1; i < points.size(); ++i) {
        const PixelPoint& last = points[kept.back()];
        if (std::abs(points[i].x - last.x) >= kTooClosePx || std::abs(points[i].y - last.y) >= kTooClosePx)
            kept.push_back(i);
    }
    return kept;
}

}  // namespace corda::view
