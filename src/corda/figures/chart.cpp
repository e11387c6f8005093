#include "corda/figures/chart.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/report/writers.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda::figures {
namespace {

view::NumberTitle title_of_axis(const AxisDef& axis, double size) {
    if (axis.unit == "s") return {axis.text + " (s)", 1.0};
    return view::title_of(axis.text, axis.unit, size);
}

/// Relative luminance of a colour over white, as WCAG 2.1 defines it, without its gamma of sRGB's foot.
double luminance(const Color& color) {
    const auto linear = [&](int channel) {
        constexpr double kGamma = 2.2;
        const double over_white = (channel * color.a + 255.0 * (255 - color.a)) / (255.0 * 255.0);
        return std::pow(over_white, kGamma);
    };
    return 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
}

bool all_show(const std::vector<Color>& colors) {
    return std::ranges::all_of(colors, shows_on_white);
}

}  // namespace

view::ValueRange range_of(const std::vector<Curve>& curves, double view::CurvePoint::*value) {
    view::ValueRange range;
    for (const Curve& curve : curves)
        for (const view::CurvePoint& point : curve.points)
            if (std::isfinite(point.*value)) range.include(point.*value);
    return range;
}

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
    const view::NumberTitle x_title = title_of_axis(x, range_of(curves, &view::CurvePoint::x).largest());
    const view::NumberTitle y_title = title_of_axis(y, range_of(curves, &view::CurvePoint::y).largest());
    report::Plot plot{id, title, x_title.text, y_title.text, false, false, {}};
    plot.has_markers = false;
    for (const Curve& curve : curves) {
        report::Series& series = plot.series.emplace_back();
        series.name = curve.name;
        series.color = curve.color;
        for (const view::CurvePoint& point : curve.points)
            series.points.emplace_back(point.x / x_title.unit, point.y / y_title.unit);
    }
    return plot;
}

std::vector<Curve> curves_of(const Scene& scene, const System& system, const MotionSummary& motion,
                             CurvePoints BodyCurves::*curve) {
    std::vector<std::size_t> bodies;
    for (const BodyCurves& body : motion.bodies) bodies.push_back(body.followed.body);
    const std::vector<std::string> colors = curve_colors(scene, bodies);
    std::vector<Curve> curves;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const std::string name =
            bodies.size() == 1 ? "" : view::translated_name(system, bodies[i], scene.overlay.language);
        curves.push_back({name, motion.bodies[i].*curve, colors[i]});
    }
    return curves;
}

std::string left_out_text(const System& system, const MotionSummary& motion) {
    const std::size_t moving = pipeline::moving_count(system);
    if (moving <= motion.bodies.size()) return {};
    const std::size_t count = moving - motion.bodies.size();
    return fmt::format(" {} more bod{} not shown.", count, count == 1 ? "y is" : "ies are");
}

bool shows_on_white(Color color) {
    constexpr double kContrast = 2.0;
    constexpr double kGlare = 0.05;
    return (1.0 + kGlare) / (luminance(color) + kGlare) >= kContrast;
}

void prefer_paper(Scene& scene) {
    StyleDef& style = scene.style;
    const auto& ground = style.background;
    const bool is_dark = ground && (shows_on_white(ground->top) || shows_on_white(ground->bottom));
    const bool show = all_show(style.palette) && std::ranges::all_of(scene.body_styles, [](const auto& body) {
                          return (!body.color || shows_on_white(*body.color)) && all_show(body.link_colors);
                      });
    if (!style.theme && !is_dark && show) style.theme = Theme::kPaper;
}

std::vector<std::string> curve_colors(const Scene& scene, const std::vector<std::size_t>& bodies) {
    const std::vector<Color> palette = view::look_of(scene.style).palette;
    std::vector<std::string> texts;
    std::size_t next = 0;
    for (std::size_t b = 0; !bodies.empty() && b <= bodies.back(); ++b) {
        const BodyStyleDef own = b < scene.body_styles.size() ? scene.body_styles[b] : BodyStyleDef{};
        Color color = own.color ? *own.color : palette[next++ % palette.size()];
        if (std::ranges::find(bodies, b) == bodies.end()) continue;
        color.a = 255;
        const std::string text = color.text();
        const bool is_taken = std::ranges::find(texts, text) != texts.end();
        const bool tells_bodies = scene.style.color_by == ColorBy::kBody;
        if (is_taken || !tells_bodies || !shows_on_white(color))
            return std::vector<std::string>(bodies.size());
        texts.push_back(text);
    }
    return texts;
}

}  // namespace corda::figures
