#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/vector.hpp"
#include "corda/report/writers.hpp"
#include "corda/view/plot_axis.hpp"

namespace corda::report {
namespace {

using view::PixelPoint;
using view::PlotAxis;
using view::rounded;
using view::ValueRange;

/// Colours that colour-blind readers can tell apart (after Okabe and Ito 2008, without their yellow and
/// black).
constexpr std::array<const char*, Series::kLooks> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#e69f00", "#56b4e9", "#7a5fd0", "#8c6d31"};
constexpr Color kInk{0, 0, 0};
constexpr Color kPaper{255, 255, 255};
constexpr Color kGrid{0xdd, 0xdd, 0xdd};
constexpr Color kContext{0xb4, 0xba, 0xc2};
constexpr double kPointsPerInch = 72.0;
constexpr double kLetterPt = 8.0;

// Shares of the em.
constexpr double kEdge = 0.5;
constexpr double kAboveBox = 0.3;  // from the highest label
constexpr double kThinLine = 0.05;
constexpr double kContextLine = 0.08;
constexpr double kCurveLine = 0.11;
constexpr double kMarkedLine = 0.15;
constexpr double kContextMarker = 0.12;  // radius
constexpr double kMarker = 0.25;
constexpr double kSample = 2.0;  // of a line in the key
constexpr double kPerLabel = 3.0;

constexpr int kMinLabels = 2;
constexpr int kMaxLabels = 8;
// Limits of the height over the width of a box with equal scales, and the margin in it.
constexpr double kFlattest = 0.15;
constexpr double kTallest = 1.1;
constexpr double kMargin = 0.04;

bool is_drawable(double value, bool is_log) {
    return std::isfinite(value) && (!is_log || value > 0.0);
}

bool is_drawable(const Plot& plot, const std::pair<double, double>& point) {
    return is_drawable(point.first, plot.log_x) && is_drawable(point.second, plot.log_y);
}

/// The ends of the error bar of a point; none if there is no bar, or one that cannot be drawn.
std::vector<double> bar_of(const Plot& plot, const Series& series, std::size_t point) {
    if (series.spreads.empty()) return {};
    const auto [least, most] = series.spreads[point];
    if (!is_drawable(least, plot.log_y) || !is_drawable(most, plot.log_y)) return {};
    return {least, most};
}

/// Wide enough to draw.
ValueRange drawable(const ValueRange& range) {
    if (range.low > range.high) return {0.0, 1.0};
    constexpr double kMinShare = 1e-6;
    const double least = kMinShare * range.largest();
    const bool is_wide = view::can_be_divided(range.extent()) && range.extent() >= least;
    return is_wide ? range : range.widened(least > 0.0 ? least : 1.0);
}

/// How a series is drawn.
struct Look {
    std::string name;  ///< in the key; empty: none
    Color color;
    std::size_t marker = 0;
    double marker_em = 0.0;  ///< radius; 0: none
    double line_em = 0.0;
};

/// A plot as a draw list. Lengths in print are pixels at kPrintPpi.
class Drawing {
  public:
    Drawing(const Plot& plot, int width_mm) : plot_(plot) {
        list_.width = rounded(kPrintPpi * width_mm / kMmPerInch);
        list_.ground = {kPaper, kPaper};
        area_.em_px = rounded(kLetterPt / kPointsPerInch * kPrintPpi);
        area_.line_px = px(kThinLine);
        set_looks();
        place();
        list_.add_layer(kGrid);
        area_.add_grid(list_);
        for (const bool is_context : {true, false}) {
            for (std::size_t i = 0; i < plot_.series.size(); ++i)
                if (plot_.series[i].is_context == is_context) draw(plot_.series[i], looks_[i]);
        }
        draw_frame();
        draw_key();
    }

    [[nodiscard]] const view::DrawList& list() const { return list_; }

  private:
    [[nodiscard]] int px(double share) const { return rounded(share * area_.em_px); }
    [[nodiscard]] int width_px(const std::string& text) { return font_.width_px(text, area_.em_px); }
    void write(const std::string& text, int x_px, int y_px) {
        font_.write({x_px, y_px, area_.em_px, kInk, text}, list_);
    }

    /// Of all series, and of those in the key: with a name and points, the context once.
    void set_looks() {
        std::size_t place = 0;
        bool has_context = false;
        for (const Series& series : plot_.series) {
            Look look{printable(plot_.context_name), kContext, 0, kContextMarker, kContextLine};
            if (!series.is_context) {
                look.name = printable(series.name);
                look.marker = series.look.value_or(place++);
                look.color =
                    Color::parse(series.color.empty() ? kColors[look.marker % kColors.size()] : series.color)
                        .value();
                const bool has_markers = plot_.has_markers && series.form != Series::Form::kLine;
                look.marker_em = has_markers ? kMarker : 0.0;
                look.line_em = has_markers ? kMarkedLine : kCurveLine;
                if (series.form == Series::Form::kPoints) look.line_em = 0.0;
            }
            looks_.push_back(look);
            const bool is_drawn = std::ranges::any_of(
                series.points, [&](const auto& point) { return is_drawable(plot_, point); });
            if (!is_drawn || look.name.empty() || (series.is_context && has_context)) continue;
            has_context |= series.is_context;
            key_.push_back(look);
        }
    }

    /// Places the box, its labels and the key; sets the height of the list.
    void place() {
        ValueRange x;  // in powers of 10 on a logarithmic axis
        ValueRange y;
        const auto include = [](double value, bool is_log, ValueRange& range) {
            range.include(is_log ? std::log10(value) : value);
        };
        for (const Series& series : plot_.series) {
            for (std::size_t i = 0; i < series.points.size(); ++i) {
                const auto& point = series.points[i];
                if (!is_drawable(plot_, point)) continue;
                include(point.first, plot_.log_x, x);
                include(point.second, plot_.log_y, y);
                for (const double end : bar_of(plot_, series, i)) include(end, plot_.log_y, y);
            }
        }
        const int title_rows = plot_.caption.empty() ? 2 : 1;
        area_.box = {px(kEdge), px(kEdge + kAboveBox + title_rows * view::kLine), list_.width - px(1.5), 0};
        // Labels at the left narrow the box.
        for (int pass = 0; pass < 2; ++pass) {
            fit_axes(drawable(x), drawable(y));
            int widest_px = 0;
            for (const PlotAxis::Label& label : area_.y.labels)
                widest_px = std::max(widest_px, width_px(label.text));
            if (pass == 0) area_.box.x0 += widest_px + px(view::kGap + view::kTickLength);
        }
        area_.x.set_labels_apart(kMaxLabels, px(view::kGap), area_.em_px, font_);
        place_key();
    }

    void fit_axes(ValueRange x, ValueRange y) {
        double height_per_width = plot_.height_per_width;
        if (plot_.has_equal_scales) {
            const double margin = 2.0 * kMargin * std::max(x.extent(), y.extent());
            x = x.widened(x.extent() + margin);
            y = y.widened(y.extent() + margin);
            height_per_width = std::clamp(y.extent() / x.extent(), kFlattest, kTallest);
            x = x.widened(y.extent() / height_per_width);
            y = y.widened(x.extent() * height_per_width);
        }
        area_.box.y1 = area_.box.y0 + rounded(height_per_width * area_.box.width());
        area_.x = {x.low, x.high, area_.box.x0, area_.box.x1 - 1, plot_.log_x, printable(plot_.x_title),
                   1.0,   {}};
        area_.y = {y.low, y.high, area_.box.y1 - 1, area_.box.y0, plot_.log_y, printable(plot_.y_title),
                   1.0,   {}};
        area_.x.language = area_.y.language = plot_.language;
        const int y_labels =
            std::clamp(rounded(area_.box.height() / (kPerLabel * area_.em_px)), kMinLabels, kMaxLabels);
        if (!plot_.has_equal_scales) {
            area_.x.extend_to_labels(kMaxLabels);
            area_.y.extend_to_labels(y_labels);
        }
        area_.y.set_labels(y_labels);
    }

    void place_key() {
        int widest_px = 0;
        for (const Look& look : key_) widest_px = std::max(widest_px, width_px(look.name));
        entry_px_ = widest_px + px(kSample + 2.0);
        const auto entries = static_cast<int>(key_.size());
        columns_ = std::clamp((list_.width - 2 * px(kEdge)) / entry_px_, 1, std::max(1, entries));
        const int rows = (entries + columns_ - 1) / columns_;
        list_.height = area_.box.y1 + px(view::kTickLength + 2.0 * view::kLine) + rows * px(view::kLine) +
                       px(rows > 0 ? 1.0 : kEdge);
    }

    void add_line(PixelPoint from, PixelPoint to, double width_em) {
        list_.add_capsule(from, to, 0.5 * width_em * area_.em_px);
    }

    /// A disc, or a polygon with round corners.
    void add_marker(PixelPoint at, const Look& look) {
        struct Polygon {
            int corners;
            double turn;  ///< of the first corner from straight up, in eighths
        };
        constexpr std::array<Polygon, 5> kShapes{{{0, 0.0}, {4, 1.0}, {3, 0.0}, {4, 0.0}, {3, 4.0}}};
        const auto& [corners, turn] = kShapes[look.marker % kShapes.size()];
        const double radius_px = look.marker_em * area_.em_px;
        list_.add_capsule(at, at, (corners == 0 ? 1.0 : 0.6) * radius_px);
        for (int i = 0; i < corners; ++i) {
            const auto corner = [&, count = corners, first = turn](int k) {
                const double angle = std::numbers::pi * (first / 4.0 + 2.0 * k / count);
                return PixelPoint{at.x + radius_px * std::sin(angle), at.y - radius_px * std::cos(angle)};
            };
            list_.add_capsule(corner(i), corner(i + 1), 0.3 * radius_px);
        }
    }

    void draw(const Series& series, const Look& look) {
        list_.add_layer(look.color);
        std::vector<PixelPoint> line;  // up to a point that cannot be drawn
        const auto end_line = [&] {
            const std::vector<std::size_t> kept =
                look.line_em > 0.0 ? view::visible_points(line) : std::vector<std::size_t>();
            for (std::size_t k = 1; k < kept.size(); ++k)
                add_line(line[kept[k - 1]], line[kept[k]], look.line_em);
            line.clear();
        };
        for (std::size_t i = 0; i < series.points.size(); ++i) {
            const auto& [x, y] = series.points[i];
            if (!is_drawable(plot_, series.points[i])) {
                end_line();
                continue;
            }
            line.push_back({area_.x.px(x), area_.y.px(y)});
            if (look.marker_em > 0.0) add_marker(line.back(), look);
            if (const auto bar = bar_of(plot_, series, i); !bar.empty())
                add_line({line.back().x, area_.y.px(bar[0])}, {line.back().x, area_.y.px(bar[1])},
                         kContextLine);
        }
        end_line();
    }

    void draw_frame() {
        area_.draw_axes(kInk, kInk, list_, font_);
        write(area_.y.title, px(kEdge), area_.box.y0 - px(0.6 + kAboveBox));
        if (!plot_.caption.empty()) return;
        const std::string title = printable(plot_.title);
        write(title, (list_.width - width_px(title)) / 2, px(kEdge + view::kAscent));
    }

    void draw_key() {
        const int left_px = std::max(px(kEdge), (list_.width - columns_ * entry_px_) / 2 + px(0.5));
        int index = 0;
        for (const Look& look : key_) {
            const int x_px = left_px + index % columns_ * entry_px_;
            const int y_px = area_.box.y1 + px(view::kTickLength + 2.0 * view::kLine) +
                             (index / columns_ + 1) * px(view::kLine);
            ++index;
            const double middle_px = y_px - 0.5 * view::kAscent * area_.em_px;
            const double end_px = x_px + kSample * area_.em_px;
            list_.add_layer(look.color);
            if (look.line_em > 0.0) add_line({1.0 * x_px, middle_px}, {end_px, middle_px}, look.line_em);
            if (look.marker_em > 0.0) add_marker({0.5 * (x_px + end_px), middle_px}, look);
            write(look.name, x_px + px(kSample + view::kGap), y_px);
        }
    }

    const Plot& plot_;
    view::DrawList list_;
    view::Font font_;
    view::PlotBox area_;
    std::vector<Look> looks_;
    std::vector<Look> key_;
    int columns_ = 1;
    int entry_px_ = 0;
};

}  // namespace

const char* ending(PlotFormat format) {
    constexpr std::array<const char*, 3> kEndings{"png", "svg", "pdf"};
    return kEndings[static_cast<std::size_t>(format)];
}

std::string draw_plot(const Plot& plot, PlotFormat format, int width_mm) {
    const Drawing drawing(plot, width_mm);
    const view::DrawList& list = drawing.list();
    if (format == PlotFormat::kPng)
        return media::png_bytes(render::render_reference(list), {.text = {}, .pixels_per_inch = kPrintPpi});
    const render::PageDef page{list.width, list.height, 1.0 * width_mm, plot.title};
    const auto file = format == PlotFormat::kSvg ? render::make_svg(page) : render::make_pdf(page);
    file->draw(list, 0, 0);
    return file->finish();
}

}  // namespace corda::report
