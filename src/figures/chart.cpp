#include "corda/figures/chart.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/figures/paper.hpp"
#include "corda/report/writers.hpp"
#include "corda/view/number_text.hpp"

namespace corda::figures {
namespace {

struct Range {
    double low = HUGE_VAL;
    double high = -HUGE_VAL;

    void include(double value) {
        if (!std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    [[nodiscard]] double size() const { return low > high ? 0.0 : std::max(std::abs(low), std::abs(high)); }
};

view::NumberTitle title_of_axis(const AxisDef& axis, double size) {
    const bool is_plain = axis.unit == "s" || axis.unit == "rad" || axis.unit == "rad/s";
    if (is_plain) return {fmt::format("{} ({})", axis.text, axis.unit), 1.0};
    return view::title_of(axis.text, axis.unit, size);
}

}  // namespace

std::string quantity_text(double value, const std::string& unit) {
    constexpr double kMinPlain = 1e-3;
    if (unit.empty()) {
        const bool is_plain = value == 0.0 || std::abs(value) >= kMinPlain || !std::isfinite(value);
        return is_plain ? report::short_number(value) : view::power_text(value);
    }
    // " (kN)"
    const view::NumberTitle title = view::title_of("", unit, std::abs(value));
    return report::short_number(value / title.unit) + " " + title.text.substr(2, title.text.size() - 3);
}

std::string time_text(double time_s) {
    return fmt::format("{:.4g} s", time_s);
}

report::Plot make_plot(const std::string& id, const std::string& title, const AxisDef& x, const AxisDef& y,
                       const std::vector<Curve>& curves) {
    Range x_range;
    Range y_range;
    for (const Curve& curve : curves) {
        for (const CurvePoint& point : curve.points) {
            x_range.include(point.x);
            y_range.include(point.y);
        }
    }
    const view::NumberTitle x_title = title_of_axis(x, x_range.size());
    const view::NumberTitle y_title = title_of_axis(y, y_range.size());
    report::Plot plot{id, title, x_title.text, y_title.text, false, false, {}};
    plot.has_markers = false;
    if (curves.size() > 1) {  // room for the key
        constexpr std::size_t kNamesPerRow = 3;
        constexpr double kRow = 0.05;
        const std::size_t rows = (curves.size() - 1) / kNamesPerRow + 1;
        plot.height_per_width += kRow * static_cast<double>(rows);
    }
    for (const Curve& curve : curves) {
        report::Series& series = plot.series.emplace_back();
        series.name = curve.name;
        series.color = curve.color;
        series.is_joined = curve.is_joined;
        for (const CurvePoint& point : curve.points)
            series.points.emplace_back(point.x / x_title.unit, point.y / y_title.unit);
    }
    return plot;
}

std::vector<Curve> curves_of(const Scene& scene, const System& system, const MotionSummary& motion,
                             Thinner BodyCurves::*curve) {
    std::vector<std::size_t> bodies;
    for (const BodyCurves& body : motion.bodies) bodies.push_back(body.followed.body);
    const std::vector<std::string> colors = curve_colors(scene, bodies);
    std::vector<Curve> curves;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const std::string name = bodies.size() == 1 ? "" : body_name(system, bodies[i]);
        curves.push_back({name, (motion.bodies[i].*curve).points(), colors[i]});
    }
    return curves;
}

void fit_height(report::Plot& plot) {
    constexpr double kFlattest = 0.3;
    constexpr double kTallest = 1.15;
    // Shares of a narrow picture's width: of the box, and of the letters above and below it.
    constexpr double kBox = 0.82;
    constexpr double kLetters = 0.17;
    const double key = plot.height_per_width - report::Plot{}.height_per_width;
    Range x;
    Range y;
    for (const report::Series& series : plot.series) {
        for (const auto& point : series.points) {
            x.include(point.first);
            y.include(point.second);
        }
    }
    const double width = x.high - x.low;
    if (!(width > 0.0)) return;
    plot.height_per_width = std::clamp(kBox * (y.high - y.low) / width + kLetters + key, kFlattest, kTallest);
}

std::string thinning_text(const MotionSummary& motion) {
    if (motion.rows <= Thinner::kMaxPoints) return {};
    return fmt::format(
        " At most {1} points of the {0} rows are drawn: the first, the last and the extremes of each block "
        "of rows. The CSV has all rows.",
        motion.rows, Thinner::kMaxPoints);
}

std::string left_out_text(const System& system, const MotionSummary& motion) {
    const std::size_t moving = pipeline::moving_count(system);
    if (moving <= motion.bodies.size()) return {};
    const std::size_t count = moving - motion.bodies.size();
    return fmt::format(" {} more bod{} not shown.", count, count == 1 ? "y is" : "ies are");
}

}  // namespace corda::figures
