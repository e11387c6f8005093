#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <thread>

#include "corda/media/defs.hpp"
#include "samples.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::report {
namespace {

using test::run_shell;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Sets an environment variable during its lifetime.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name) {
        if (const char* const old = std::getenv(name)) old_ = old;
        setenv(name, value.c_str(), 1);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }

  private:
    const char* name_;
    std::optional<std::string> old_;
};

TEST(Plots, ScriptsQuoteEveryText) {
    const std::string script = gnuplot_script(small_plot(), PlotFormat::kSvg);
    EXPECT_THAT(script,
                HasSubstr("set title 'Error, a_b, \"q\" <b>&amp; | *x* '.\"'\".'y'.\"'\".' `touch pwned`"));
    EXPECT_THAT(script, HasSubstr("set logscale x\n"));
    EXPECT_THAT(script, HasSubstr("0.01 0.0001\nNaN NaN\nEND\n"));  // a zero breaks the line
    EXPECT_THAT(script, HasSubstr("keyentry"));
    Plot linear = small_plot();
    linear.log_x = linear.log_y = false;
    EXPECT_THAT(gnuplot_script(linear, PlotFormat::kSvg),
                AllOf(HasSubstr("0.10000000000000001 0\nEND"), Not(HasSubstr("logscale"))));
}

TEST(Plots, HaveTheRightSize) {
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
        const std::string png = folder.write(plot.id + ".png", draw_plot(plot, PlotFormat::kPng));
        const Image image = read_png(png);
        EXPECT_EQ(image.width(), 1200) << plot.id;
        EXPECT_EQ(image.height(), 800) << plot.id;
        const std::string svg = folder.write(plot.id + ".svg", draw_plot(plot, PlotFormat::kSvg));
        const auto result = run_shell("xmllint --noout --nonet " + test::quoted(svg));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_THAT(test::read_file(svg), HasSubstr("viewBox=\"0 0 1200 800\"")) << plot.id;
    }
    const std::string pdf = folder.write("one.pdf", draw_plot(one, PlotFormat::kPdf));
    EXPECT_THAT(run_shell("pdfinfo " + test::quoted(pdf)).out, HasSubstr("Page size:       481 x 320 pts"));
    EXPECT_FALSE(std::filesystem::exists("pwned"));
    EXPECT_THAT(test::read_file(folder.file("error.svg")), HasSubstr("`touch pwned` $(touch pwned) @m \\"));
    EXPECT_THAT(test::read_file(folder.file("error.svg")), HasSubstr("never (no points)"));
}

TEST(Plots, HaveLettersOfEightPointsAtAnyWidthInPrint) {
    const test::ScratchFolder folder;
    Plot plot = small_plot();
    plot.caption = "A caption.";
    for (const int width_mm : {85, 170}) {
        const std::string png = folder.write("a.png", draw_plot(plot, PlotFormat::kPng, width_mm));
        EXPECT_NEAR(read_png(png).width(), width_mm / 25.4 * 300.0, 1.0);
        EXPECT_NEAR(read_png_info(png).pixels_per_inch, 300.0, 0.1);
        const std::string pdf = folder.write("a.pdf", draw_plot(plot, PlotFormat::kPdf, width_mm));
        // The height of a word is that of the font's box, 1.163 times the font size.
        const auto words = run_shell("pdftotext -bbox " + pdf + " - | grep 'Step'");
        double top = 0.0;
        double bottom = 0.0;
        ASSERT_EQ(std::sscanf(words.out.c_str(), " <word xMin=\"%*f\" yMin=\"%lf\" xMax=\"%*f\" yMax=\"%lf\"",
                              &top, &bottom),
                  2)
            << words.out;
        EXPECT_NEAR(bottom - top, 1.163 * 8.0, 0.1);
        const std::string svg = draw_plot(plot, PlotFormat::kSvg, width_mm);
        EXPECT_THAT(svg, HasSubstr("width=\"" + std::to_string(width_mm) + "mm\" height="));
        EXPECT_THAT(svg, HasSubstr("font-size=\"8.00\""));
        EXPECT_THAT(svg, HasSubstr(width_mm == 85 ? "viewBox=\"0 0 241 161\"" : "viewBox=\"0 0 482 321\""));
    }
    EXPECT_THAT(gnuplot_script(plot, PlotFormat::kPdf, 85), Not(HasSubstr("set title")));
    EXPECT_EQ(file_stem("a", 85), "a_85mm");
    EXPECT_EQ(file_stem("a", {}), "a");
}

TEST(Plots, OfPathsHaveEqualScalesWithAMargin) {
    Plot plot = small_plot();
    plot.log_x = plot.log_y = false;
    plot.has_equal_scales = true;
    plot.has_markers = false;
    plot.series = {{"a", {{0.0, 1.0}, {100.0, 11.0}}}, {"b", {{0.0, 1.0}}}};
    plot.series[0].color = "#123456";
    plot.series[1].is_joined = false;
    const std::string script = gnuplot_script(plot, PlotFormat::kSvg);
    EXPECT_THAT(script, AllOf(HasSubstr("set size ratio -1\n"), HasSubstr("set xrange [-4:104]\n"),
                              HasSubstr("set yrange [-3:15]\n"), HasSubstr("$s0 with lines "),
                              HasSubstr("linecolor rgb '#123456'"), HasSubstr("$s1 with points ")));
}

TEST(Plots, HaveTheSameBytesAtAnotherTime) {
    for (const PlotFormat format : {PlotFormat::kPng, PlotFormat::kSvg, PlotFormat::kPdf}) {
        const std::string first = draw_plot(small_plot(), format);
        std::this_thread::sleep_for(std::chrono::milliseconds(1100));
        EXPECT_EQ(draw_plot(small_plot(), format), first) << ending(format);
        const Environment zone("TZ", "Asia/Kolkata");
        EXPECT_EQ(draw_plot(small_plot(), format), first) << ending(format) << " in another time zone";
    }
}

TEST(Plots, ContextIsGreyBehindTheOthersWithOneEntryInTheKey) {
    Plot plot = small_plot();
    plot.series = {{.name = "a", .points = {{1.0, 1.0}}},
                   {.name = "b", .points = {{1.0, 2.0}}, .is_context = true},
                   {.name = "c", .points = {{1.0, 3.0}}, .is_context = true},
                   {.name = "d", .points = {{1.0, 4.0}}, .look = 3}};
    plot.context_name = "the rest";
    const std::string script = gnuplot_script(plot, PlotFormat::kSvg);
    const std::string items = script.substr(script.find("plot $"));
    EXPECT_LT(items.find("$s1"), items.find("$s2"));
    EXPECT_LT(items.find("$s2"), items.find("$s0"));
    EXPECT_THAT(items, AllOf(HasSubstr("title 'the rest'"), HasSubstr("notitle"), Not(HasSubstr("'b'"))));
    EXPECT_THAT(items.substr(items.find("$s3")), HasSubstr("'#cc79a7'"));  // its own look
}

TEST(Plots, SpreadsAreBarsOfTheSeriesColour) {
    Plot plot = small_plot();
    plot.series = {{.name = "a", .points = {}}};
    plot.series[0].add(1.0, 2.0, {1.5, 3.0});
    const std::string script = gnuplot_script(plot, PlotFormat::kSvg);
    EXPECT_THAT(script, HasSubstr("\n1 2 1.5 3\n"));
    EXPECT_THAT(script, HasSubstr("$s0 with yerrorbars linewidth 1.2 linecolor rgb '#0072b2'"));
    EXPECT_FALSE(draw_plot(plot, PlotFormat::kSvg).empty());
}

TEST(Plots, MissingGnuplotNamesItsPackage) {
    const test::ScratchFolder folder;
    const Environment path("PATH", folder.path());
    for (const auto& action : {std::function<void()>([] { check_gnuplot(); }), std::function<void()>([] {
                                   (void)draw_plot(small_plot(), PlotFormat::kPng);
                               })}) {
        try {
            action();
            FAIL() << "no error";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kIo);
            EXPECT_THAT(error.what(), AllOf(HasSubstr("gnuplot does not start: No such file or directory"),
                                            HasSubstr("apt-get install gnuplot-nox")));
        }
    }
}

TEST(Plots, TruncatedPicturesAreRefused) {
    const test::ScratchFolder folder;
    const std::string end = " | head -c -20\n";
    const std::string fake = folder.write("gnuplot", "#!/bin/sh\nPATH=/usr/bin:/bin\ngnuplot \"$@\"" + end);
    std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
    const Environment path("PATH", folder.path());
    for (const PlotFormat format : {PlotFormat::kPng, PlotFormat::kSvg, PlotFormat::kPdf}) {
        const auto failure = test::failure_of([&] { (void)draw_plot(small_plot(), format); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("breaks off"));
    }
}

TEST(Plots, FailureOfGnuplotIsReported) {
    const test::ScratchFolder folder;
    const std::string fake = folder.write("gnuplot", "#!/bin/sh\necho 'no such terminal' >&2\nexit 3\n");
    std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
    const Environment path("PATH", folder.path());
    try {
        (void)draw_plot(small_plot(), PlotFormat::kPng);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kIo);
        EXPECT_STREQ(error.what(), "gnuplot cannot draw 'error' (status 3): no such terminal");
    }
    EXPECT_EQ(test::code_of([] { check_gnuplot(); }), ExitCode::kIo);
}

}  // namespace
}  // namespace corda::report
