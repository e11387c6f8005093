#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string_view>
#include <thread>
#include <tuple>

#include "corda/media/defs.hpp"
#include "samples.hpp"
#include "support/command.hpp"

namespace corda::report {
namespace {

using test::run_shell;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string svg_of(const Plot& plot) {
    return draw_plot(plot, PlotFormat::kSvg, kPageMm);
}

/// The words of a plot, one line each.
std::string words_of(const Plot& plot) {
    const test::ScratchFolder folder;
    const std::string pdf = folder.write("a.pdf", draw_plot(plot, PlotFormat::kPdf, kPageMm));
    return "\n" + run_shell("pdftotext -raw " + pdf + " -").out;
}

/// Of strokes of #123456 in an SVG.
constexpr const char* kInk = "stroke:rgb(7.058824%,20.392157%,33.72549%)";

std::size_t count_of(std::string_view text, std::string_view word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1))
        ++count;
    return count;
}

TEST(DrawPlot, TakesAnyTextAndAnyPoints) {
    const test::ScratchFolder folder;
    Plot empty = small_plot();
    empty.id = "empty";
    empty.series.clear();
    Plot pointless = small_plot();
    pointless.id = "pointless";
    pointless.series = {{"never", {{-1.0, 1.0}}}};
    Plot one = small_plot();
    one.id = "one";
    one.series = {{"one", {{1.0, 1.0}}}};
    for (const Plot& plot : {small_plot(), empty, pointless, one}) {
        for (const PlotFormat format : {PlotFormat::kPng, PlotFormat::kSvg, PlotFormat::kPdf})
            std::ignore = folder.write(plot.id + "." + ending(format), draw_plot(plot, format, kPageMm));
    }
    EXPECT_EQ(run_shell("cd " + folder.path() + " && xmllint --noout --nonet *.svg").err, "");
    EXPECT_THAT(words_of(small_plot()),
                AllOf(HasSubstr("Error, a_b, \"q\" <b>&amp; | *x* 'y' `touch pwned`"), HasSubstr("Step / s"),
                      HasSubstr("exact"), Not(HasSubstr("never"))));
    EXPECT_THAT(words_of(pointless), HasSubstr("10⁰"));
}

TEST(DrawPlot, HasLettersOfEightPointsAtAnyWidthInPrint) {
    const test::ScratchFolder folder;
    Plot plot = small_plot();
    plot.caption = "A caption.";
    for (const int width_mm : {kColumnMm, kPageMm}) {
        const std::string png = folder.write("a.png", draw_plot(plot, PlotFormat::kPng, width_mm));
        EXPECT_NEAR(read_png(png).width(), width_mm / 25.4 * 300.0, 1.0);
        EXPECT_NEAR(read_png_info(png).pixels_per_inch, 300.0, 0.1);
        const std::string pdf = folder.write("a.pdf", draw_plot(plot, PlotFormat::kPdf, width_mm));
        // The height of a word is that of the font's box, 1.164 times the font size.
        const auto words = run_shell("pdftotext -bbox " + pdf + " - | grep 'Step'");
        double top = 0.0;
        double bottom = 0.0;
        ASSERT_EQ(std::sscanf(words.out.c_str(), " <word xMin=\"%*f\" yMin=\"%lf\" xMax=\"%*f\" yMax=\"%lf\"",
                              &top, &bottom),
                  2)
            << words.out;
        EXPECT_NEAR(bottom - top, 1.164 * 8.0, 0.15);
        EXPECT_THAT(draw_plot(plot, PlotFormat::kSvg, width_mm),
                    AllOf(HasSubstr("width=\"" + std::to_string(width_mm) + "mm\" height=")));
    }
    EXPECT_EQ(file_stem("a", 85, {85, 170}), "a_85mm");
    EXPECT_EQ(file_stem("a", 85, {85}), "a");
}

TEST(DrawPlot, HasPowersOfTenOnLogarithmicAxes) {
    Plot plot = small_plot();
    plot.series = {{"a", {{2e-3, 0.5}, {0.7, 3.0}}}};
    const std::string words = words_of(plot);
    for (const char* label : {"10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹"}) EXPECT_THAT(words, HasSubstr(label));
    EXPECT_THAT(words, Not(HasSubstr("10⁻⁴")));
    plot.log_x = plot.log_y = false;
    EXPECT_THAT(words_of(plot), AllOf(HasSubstr("0.5"), Not(HasSubstr("10⁰"))));
}

TEST(DrawPlot, BreaksLinesAtPointsWithoutAPlace) {
    Plot plot = small_plot();
    plot.has_markers = false;
    plot.series = {{"", {{1.0, 1.0}, {2.0, 2.0}, {3.0, 0.0}, {4.0, 2.0}, {5.0, 3.0}}}};
    plot.series[0].color = "#123456";
    const std::string svg = svg_of(plot);
    const std::string path = svg.substr(svg.find(kInk));
    EXPECT_EQ(count_of(path.substr(0, path.find("/>")), "M "), 2U);
}

TEST(DrawPlot, OfAPathHasEqualScales) {
    Plot plot = small_plot();
    plot.log_x = plot.log_y = false;
    plot.has_equal_scales = true;
    plot.has_markers = false;
    plot.series = {{"a", {{0.0, 0.0}, {100.0, 0.0}, {100.0, 50.0}}}};
    plot.series[0].color = "#123456";
    const std::string svg = svg_of(plot);
    std::vector<double> at(6);
    const char* const path = svg.c_str() + svg.find("d=\"M", svg.find(kInk));
    ASSERT_EQ(std::sscanf(path, "d=\"M %lf %lf L %lf %lf L %lf %lf", &at[0], &at[1], &at[2], &at[3], &at[4],
                          &at[5]),
              6)
        << std::string(path, 60);
    EXPECT_NEAR(at[1] - at[5], 0.5 * (at[2] - at[0]), 1.5);
}

TEST(DrawPlot, HasTheSameBytesAtAnotherTime) {
    for (const PlotFormat format : {PlotFormat::kPng, PlotFormat::kSvg, PlotFormat::kPdf}) {
        const std::string first = draw_plot(small_plot(), format, kColumnMm);
        std::this_thread::sleep_for(std::chrono::milliseconds(1100));
        EXPECT_EQ(draw_plot(small_plot(), format, kColumnMm), first) << ending(format);
    }
}

TEST(DrawPlot, HasGreyContextBehindTheOthersWithOneEntryInTheKey) {
    Plot plot = small_plot();
    plot.series = {{.name = "a", .points = {{1.0, 1.0}}},
                   {.name = "b", .points = {{1.0, 2.0}}, .is_context = true},
                   {.name = "c", .points = {{1.0, 3.0}}, .is_context = true},
                   {.name = "d", .points = {{1.0, 4.0}}, .look = 3}};
    plot.context_name = "the rest";
    const std::string svg = svg_of(plot);
    const std::size_t blue = svg.find("rgb(0%,44.705882%,69.803922%)");
    EXPECT_LT(svg.find("rgb(70.588235%,72.941176%,76.078431%)"), blue);
    EXPECT_LT(blue, svg.find("rgb(80%,47.45098%,65.490196%)"));  // its own look
    const std::string words = words_of(plot);
    EXPECT_EQ(count_of(words, "the rest"), 1U);
    EXPECT_EQ(count_of(words, "\nb\n") + count_of(words, "\nc\n"), 0U);
}

TEST(DrawPlot, HasBarsOfSpreadsInTheColourOfTheirSeries) {
    Plot plot = small_plot();
    plot.has_markers = false;
    plot.series = {{.name = "", .points = {}, .color = "#123456"}};
    plot.series[0].add(1.0, 2.0, {1.5, 3.0});
    EXPECT_THAT(svg_of(plot), HasSubstr(kInk));
    plot.series[0].spreads.clear();
    EXPECT_THAT(svg_of(plot), Not(HasSubstr(kInk)));
}

TEST(DrawPlot, HasRoomForTheBarsOfSpreads) {
    Plot plot = small_plot();
    plot.has_markers = false;
    plot.series = {{.name = "", .points = {}, .color = "#123456"}};
    plot.series[0].add(1.0, 2.0, {3e-3, 500.0});
    plot.series[0].add(2.0, 2.0, {0.0, 1e9});  // not drawn: a logarithmic axis has no place for 0
    EXPECT_THAT(words_of(plot), AllOf(HasSubstr("10⁻³"), HasSubstr("10³"), Not(HasSubstr("10⁴"))));
    plot.log_x = plot.log_y = false;
    plot.series[0].spreads = {{-40.0, 3.0}, {1.0, 70.0}};
    EXPECT_THAT(words_of(plot), AllOf(HasSubstr("−40"), HasSubstr("60")));
}

TEST(DrawPlot, KeepsEveryExtremeOfALongCurve) {
    Plot plot = small_plot();
    plot.log_x = plot.log_y = plot.has_markers = false;
    plot.series = {{.name = "", .points = {}, .color = "#123456"}};
    for (int k = 0; k < 100'000; ++k) plot.series[0].points.emplace_back(k, k == 33'333 ? 1.0 : 0.0);
    const std::string svg = svg_of(plot);
    EXPECT_LT(svg.size(), 200'000U);  // measured 96 kB
    const Plot flat = [&] {
        Plot changed = plot;
        changed.series[0].points[33'333].second = 0.5;
        return changed;
    }();
    EXPECT_NE(svg_of(flat), svg);
}

}  // namespace
}  // namespace corda::report
