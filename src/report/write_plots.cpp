#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/text.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

constexpr const char* kHint = "Corda draws plots with it; install it with: apt-get install gnuplot-nox";

/// Colours that colour-blind readers can tell apart (after Okabe and Ito 2008, without their yellow and
/// black, which cannot be seen on a light or a dark page), and shapes that differ without any colour.
constexpr std::array<const char*, Series::kLooks> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#e69f00", "#56b4e9", "#7a5fd0", "#8c6d31"};
constexpr double kPointsPerInch = 72.0;
constexpr double kLetterPt = 8.0;
constexpr double kLinePt = 0.6;
// What takes gnuplot's units to points, measured on what it drew.
constexpr double kPngFont = 0.75;
constexpr double kPdfFont = 1.5;
constexpr double kPdfLine = 2.0;

constexpr const char* kContextColor = "#b4bac2";
constexpr std::array<int, 5> kPointTypes{7, 5, 9, 13, 11};  // filled ones: open ones are thin in an SVG
constexpr std::array<int, 3> kDashTypes{1, 2, 4};

/// A text that gnuplot takes literally: in single quotes, inside which only the quote itself is special. Each
/// of those is joined on in double quotes: gnuplot takes '' for a quote only behind another character.
std::string literal(std::string_view text) {
    std::string result = printable(text);
    replace_all(result, "'", R"('."'".')");
    return "'" + result + "'";
}

bool is_drawable(double value, bool log_axis) {
    return std::isfinite(value) && (!log_axis || value > 0.0);
}

bool is_drawable(const Plot& plot, const std::pair<double, double>& point) {
    return is_drawable(point.first, plot.log_x) && is_drawable(point.second, plot.log_y);
}

bool has_points(const Plot& plot, const Series& series) {
    for (const auto& point : series.points) {
        if (is_drawable(plot, point)) return true;
    }
    return false;
}

std::string axis(char name, const std::string& title, bool is_log) {
    std::string text = fmt::format("set {}label {} noenhanced{}\n", name, literal(title),
                                   name == 'x' ? " offset 0,0.4" : "");
    if (is_log) text += fmt::format("set logscale {}\nset format {} '10^{{%L}}'\n", name, name);
    return text;
}

std::string data_block(const Plot& plot, std::size_t index) {
    std::string text = fmt::format("$s{} << END\n", index);
    const Series& series = plot.series[index];
    for (std::size_t i = 0; i < series.points.size(); ++i) {
        const auto& point = series.points[i];
        if (is_drawable(plot, point)) {
            text += fmt::format("{:.17g} {:.17g}", point.first, point.second);
            if (!series.spreads.empty())
                text += fmt::format(" {:.17g} {:.17g}", series.spreads[i].first, series.spreads[i].second);
            text += '\n';
        } else {
            text += "NaN NaN\n";
        }
    }
    return text + "END\n";
}

/// Ranges with a margin around all points: gnuplot's own end at round numbers, which a path leaves blank.
std::string ranges_around(const Plot& plot) {
    constexpr double kMargin = 0.04;  // of the larger extent
    std::array<double, 4> edges{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
    for (const Series& series : plot.series) {
        for (const auto& point : series.points) {
            if (!is_drawable(plot, point)) continue;
            edges = {std::min(edges[0], point.first), std::max(edges[1], point.first),
                     std::min(edges[2], point.second), std::max(edges[3], point.second)};
        }
    }
    if (edges[0] > edges[1]) return {};
    const double extent = std::max(edges[1] - edges[0], edges[3] - edges[2]);
    const double margin = extent > 0.0 ? kMargin * extent : 1.0;
    return fmt::format("set xrange [{:.17g}:{:.17g}]\nset yrange [{:.17g}:{:.17g}]\n", edges[0] - margin,
                       edges[1] + margin, edges[2] - margin, edges[3] + margin);
}

/// `place`: among the lines that are not context.
std::string plot_item(const Plot& plot, std::size_t index, std::size_t place) {
    const Series& series = plot.series[index];
    const bool is_drawn = has_points(plot, series);
    const std::string source = is_drawn ? fmt::format("$s{}", index) : "keyentry";
    const std::size_t look = series.look.value_or(place);
    const std::string title = series.name.empty()
                                  ? "notitle"
                                  : "title " + literal(is_drawn ? series.name : series.name + " (no points)");
    const std::string color = series.color.empty() ? kColors[look % kColors.size()] : series.color;
    if (!series.is_joined) {  // dots, which are larger in the key
        return fmt::format(
            "{0} with points pointtype 7 pointsize 0.25 linecolor rgb '{1}' notitle, \\\n"
            "keyentry with points pointtype 7 pointsize 0.7 linecolor rgb '{1}' {2}",
            source, color, title);
    }
    if (!plot.has_markers) {
        return fmt::format("{} with lines linewidth 1.5 linecolor rgb '{}' dashtype {} {}", source, color,
                           kDashTypes[look / kColors.size() % kDashTypes.size()], title);
    }
    return fmt::format("{} with linespoints linewidth 2.5 linecolor rgb '{}' pointtype {} dashtype {} {}",
                       source, color, kPointTypes[look % kPointTypes.size()],
                       kDashTypes[look / kColors.size() % kDashTypes.size()], title);
}

/// The curves for gnuplot, the context first.
std::vector<std::string> plot_items(const Plot& plot) {
    std::vector<std::string> items;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        if (!plot.series[i].is_context || !has_points(plot, plot.series[i])) continue;
        items.push_back(
            fmt::format("$s{} with linespoints linewidth 1.2 linecolor rgb '{}' pointtype 7 pointsize 0.5 {}",
                        i, kContextColor, items.empty() ? "title " + literal(plot.context_name) : "notitle"));
    }
    std::size_t place = 0;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const Series& series = plot.series[i];
        if (series.is_context) continue;
        const std::size_t look = series.look.value_or(place);
        if (!series.spreads.empty() && has_points(plot, series)) {
            items.push_back(
                fmt::format("$s{} with yerrorbars linewidth 1.2 linecolor rgb '{}' pointsize 0 notitle", i,
                            kColors[look % kColors.size()]));
        }
        items.push_back(plot_item(plot, i, place++));
    }
    return items;
}

/// Terminal of a plot of that width in print. All lengths are in points; letters have 8.
std::string print_terminal(const Plot& plot, PlotFormat format, int width_mm) {
    const double width_in = width_mm / kMmPerInch;
    const double height_in = width_in * plot.height_per_width;
    const double width_pt = kPointsPerInch * width_in;
    const double height_pt = kPointsPerInch * height_in;
    std::string text;
    if (format == PlotFormat::kPng) {
        const double px_per_pt = kPrintPpi / kPointsPerInch;
        text = fmt::format(
            "set terminal pngcairo size {:.0f},{:.0f} enhanced font 'sans,{:g}' linewidth {:.4f} "
            "background rgb 'white'\n",
            kPrintPpi * width_in, kPrintPpi * height_in, kLetterPt * px_per_pt * kPngFont,
            kLinePt * px_per_pt);
    } else if (format == PlotFormat::kPdf) {
        text = fmt::format(
            "set terminal pdfcairo size {:.4f}in,{:.4f}in enhanced font 'sans,{:g}' linewidth {}\n", width_in,
            height_in, kPdfFont * kLetterPt, kPdfLine * kLinePt);
    } else {
        text = fmt::format(
            "set terminal svg size {:.0f},{:.0f} dynamic enhanced font 'sans-serif,{:g}' linewidth {} name "
            "'{}'\n",
            width_pt, height_pt, kLetterPt, kLinePt, plot.id);
    }
    return text + "set tics scale 0.5\n";
}

std::string terminal(const Plot& plot, PlotFormat format, std::optional<int> width_mm) {
    if (width_mm) return print_terminal(plot, format, *width_mm);
    if (format == PlotFormat::kPng) {
        return "set terminal pngcairo size 1200,800 enhanced font 'sans,16' background rgb 'white'\n"
               "set pointsize 1.5\nset key font ',14'\n";
    }
    if (format == PlotFormat::kPdf) {
        return "set terminal pdfcairo size 17cm,11.3cm enhanced font 'sans,8' linewidth 0.5\n"
               "set pointsize 0.6\nset key font ',7'\n";
    }
    return fmt::format(
        "set terminal svg size 1200,800 dynamic enhanced font 'sans-serif,20' name '{}'\n"
        "set pointsize 0.9\nset key font ',17'\n",
        plot.id);
}

/// Whether a picture has its end. gnuplot does not say that it could not write all of it.
bool is_whole(std::string_view picture, PlotFormat format) {
    constexpr std::size_t kMaxEnd = 16;
    const std::array<const char*, 3> ends{"IEND", "</svg>", "%%EOF"};
    const std::size_t end = picture.rfind(ends[static_cast<std::size_t>(format)]);
    return end != std::string_view::npos && picture.size() - end <= kMaxEnd;
}

/// The end of gnuplot's messages, which has the reason.
std::string last_words(const std::string& text) {
    constexpr std::size_t kMaxBytes = 400;
    std::string words = text.substr(text.size() > kMaxBytes ? text.size() - kMaxBytes : 0);
    while (!words.empty() && (words.back() == '\n' || words.back() == ' ')) words.pop_back();
    words.erase(0, words.find_first_not_of(" \n"));
    return words.empty() ? "without a message" : words;
}

/// Sets the size of an SVG in print.
void add_size(const Plot& plot, int width_mm, std::string& svg) {
    const std::size_t at = svg.find(" viewBox=");
    if (at == std::string::npos) return;
    svg.insert(
        at, fmt::format(" width=\"{}mm\" height=\"{:.6g}mm\"", width_mm, width_mm * plot.height_per_width));
}

/// Sets the resolution of a PNG to kPrintPpi: the chunk pHYs of 11811 pixels per metre, with its check sum,
/// behind the chunk IHDR.
void add_resolution(std::string& png) {
    constexpr std::string_view kChunk("\0\0\0\x09pHYs\0\0\x2e\x23\0\0\x2e\x23\x01\x78\xa5\x3f\x76", 21);
    constexpr std::size_t kEndOfHeader = 33;
    png.insert(std::min(kEndOfHeader, png.size()), kChunk);
}

}  // namespace

const char* ending(PlotFormat format) {
    constexpr std::array<const char*, 3> kEndings{"png", "svg", "pdf"};
    return kEndings[static_cast<std::size_t>(format)];
}

std::string file_stem(const std::string& id, std::optional<int> width_mm) {
    return width_mm ? fmt::format("{}_{}mm", id, *width_mm) : id;
}

std::string gnuplot_script(const Plot& plot, PlotFormat format, std::optional<int> width_mm) {
    std::string text = "set encoding utf8\n" + terminal(plot, format, width_mm);
    if (plot.caption.empty()) text += fmt::format("set title {} noenhanced\n", literal(plot.title));
    if (plot.has_equal_scales) text += "set size ratio -1\n" + ranges_around(plot);
    text += axis('x', plot.x_title, plot.log_x) + axis('y', plot.y_title, plot.log_y);
    text +=
        "set grid xtics ytics linetype 1 linewidth 0.6 linecolor rgb '#b0b0b0'\n"
        "set border linewidth 1.2\n"
        "set key below center maxrows 4 Left reverse noenhanced samplen 3 spacing 1.15 height 1\n";
    bool is_empty = true;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        if (!has_points(plot, plot.series[i])) continue;
        is_empty = false;
        text += data_block(plot, i);
    }
    std::vector<std::string> items = plot_items(plot);
    // gnuplot refuses a plot without points. One that is outside the ranges gives the axes alone.
    if (is_empty) {
        text += "set xrange [1:10]\nset yrange [1:10]\n";
        items.insert(items.begin(), "NaN notitle");
    }
    return text + fmt::format("plot {}\n", fmt::join(items, ", \\\n"));
}

std::string draw_plot(const Plot& plot, PlotFormat format, std::optional<int> width_mm) {
    // -d: without the user's .gnuplot.
    const ChildResult child = run_child({"gnuplot", "-d"}, gnuplot_script(plot, format, width_mm), kHint);
    if (child.exit_code != 0 || child.out.empty()) {
        // pango ends gnuplot if it cannot start a thread.
        const bool lacks_resources = child.err.find(std::strerror(EAGAIN)) != std::string::npos ||
                                     child.err.find(std::strerror(ENOMEM)) != std::string::npos;
        throw Error(
            lacks_resources ? ExitCode::kTemporary : ExitCode::kIo,
            fmt::format(
                "gnuplot cannot draw '{}' (status {}): {}{}", plot.id, child.exit_code, last_words(child.err),
                lacks_resources ? "; run fewer processes, or raise the limits (ulimit -u, ulimit -v)" : ""));
    }
    std::string picture = child.out;
    if (!is_whole(picture, format)) {
        throw Error(ExitCode::kIo,
                    fmt::format("the picture '{}' by gnuplot breaks off; free some space in /tmp", plot.id));
    }
    // gnuplot escapes & and <, but no > where XML wants it.
    if (format == PlotFormat::kSvg) replace_all(picture, "]]>", "]]&gt;");
    if (format == PlotFormat::kPdf) forget_time(picture);
    if (width_mm && format == PlotFormat::kSvg) add_size(plot, *width_mm, picture);
    if (width_mm && format == PlotFormat::kPng) add_resolution(picture);
    return picture;
}

void check_gnuplot() {
    const ChildResult child = run_child({"gnuplot", "--version"}, "", kHint);
    if (child.exit_code == 0) return;
    throw Error(ExitCode::kIo, fmt::format("gnuplot does not run (status {}): {}; {}", child.exit_code,
                                           last_words(child.err), kHint));
}

}  // namespace corda::report
