#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include <nlohmann/json.hpp>

#include "corda/core/error.hpp"
#include "corda/media/png.hpp"
#include "corda/study/setting.hpp"
#include "corda/study/study.hpp"
#include "corda/study/writers.hpp"
#include "support/command.hpp"

namespace corda::study {
namespace {

using nlohmann::json;
using test::run_shell;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All that could be taken for something else by one of the formats.
const std::string nasty = "a_b, \"q\" <b>&amp; | *x* 'y' `touch pwned` $(touch pwned) @m \\";

Table small_table() {
    return {"speed",
            "Speed & error",
            {{"method", "Method"}, {"step_s", "Step / s"}, {"error", "Error"}, {"failure", "Failure"}},
            {{"exact", 0.1, 1.0 / 3.0, std::monostate{}},
             {nasty, 1e-5, std::monostate{}, ""},
             {"rope", 0.25, 12345.0, "it diverged"}},
            "A note."};
}

Plot small_plot() {
    Plot plot;
    plot.id = "error";
    plot.title = "Error, " + nasty;
    plot.x_title = "Step / s";
    plot.y_title = "Error / L";
    plot.series = {{"rope " + nasty, {{1e-3, 1e-6}, {1e-2, 1e-4}, {1e-1, 0.0}}},
                   {"exact", {{1e-3, 1e-12}, {std::nan(""), 1.0}, {1e-1, 1e-11}}},
                   {"never", {{-1.0, 1.0}, {1.0, kInfinity}}},
                   {"empty", {}}};
    return plot;
}

Report small_report() {
    Report report{"A <study>", {{"Processor", "Some & any <CPU>"}, {"Build", "-O3 | -g"}}, {}};
    report.chapters.push_back(
        {"First & <foremost>", {"Plain " + nasty, "2. No list"}, {small_table()}, {small_plot()}});
    Plot linear = small_plot();
    linear.id = "linear";
    linear.log_x = linear.log_y = false;
    report.chapters.push_back({"Second", {}, {}, {linear}});
    return report;
}

ExitCode code_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::kOk;
}

/// Sets an environment variable while it lives.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name), old_(std::getenv(name)) {
        setenv(name, value.c_str(), 1);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() { setenv(name_, old_.c_str(), 1); }

  private:
    const char* name_;
    std::string old_;
};

TEST(StudyWriters, CsvQuotesAndKeepsEveryDigit) {
    const std::string text = csv_text(small_table());
    EXPECT_EQ(text,
              "method,step_s,error,failure\n"
              "exact,0.10000000000000001,0.33333333333333331,\n"
              "\"a_b, \"\"q\"\" <b>&amp; | *x* 'y' `touch pwned` $(touch pwned) @m \\\","
              "1.0000000000000001e-05,,\n"
              "rope,0.25,12345,it diverged\n");
    const Table lines{"t", "", {{"k", ""}}, {{"a\nb"}, {"a\rb"}, {""}}, ""};
    EXPECT_EQ(csv_text(lines), "k\n\"a\nb\"\n\"a\rb\"\n\n");
}

TEST(StudyWriters, NumbersForPeopleHaveThreeDigits) {
    EXPECT_EQ(short_number(1.0 / 3.0), "0.333");
    EXPECT_EQ(short_number(1.23456e-5), "1.23e-5");
    EXPECT_EQ(short_number(-1.23456e-105), "-1.23e-105");
    EXPECT_EQ(short_number(2.5e12), "2.5e+12");
    EXPECT_EQ(short_number(123456.0), "123456");
    EXPECT_EQ(short_number(1234.5), "1230");
    EXPECT_EQ(short_number(999.7), "1000");
    EXPECT_EQ(short_number(-99950.5), "-100000");
    EXPECT_EQ(short_number(999600.5), "1e+6");
    EXPECT_EQ(short_number(1e6), "1e+6");
    EXPECT_EQ(short_number(-0.0), "0");
    EXPECT_EQ(short_number(kInfinity), "∞");
    EXPECT_EQ(short_number(-kInfinity), "−∞");
    EXPECT_EQ(short_number(std::nan("")), "NaN");
}

TEST(StudyWriters, JsonHoldsTheWholeReport) {
    Report report = small_report();
    report.chapters[0].tables[0].rows[0][2] = kInfinity;
    const json back = json::parse(json_text(report));
    EXPECT_EQ(back["schema"], 1);
    EXPECT_EQ(back["title"], "A <study>");
    EXPECT_EQ(back["setting"][1]["name"], "Build");
    EXPECT_EQ(back["setting"][1]["value"], "-O3 | -g");
    const json& table = back["chapters"][0]["tables"][0];
    EXPECT_EQ(table["columns"][1]["key"], "step_s");
    EXPECT_EQ(table["columns"][1]["title"], "Step / s");
    EXPECT_EQ(table["rows"][0]["step_s"].get<double>(), 0.1);
    EXPECT_TRUE(table["rows"][0]["error"].is_null());  // infinite
    EXPECT_TRUE(table["rows"][1]["error"].is_null());  // missing
    EXPECT_EQ(table["rows"][1]["method"], nasty);
    EXPECT_EQ(table["rows"][2]["failure"], "it diverged");
    const json& plot = back["chapters"][0]["plots"][0];
    EXPECT_EQ(plot["log_x"], true);
    EXPECT_EQ(plot["series"][0]["points"][1], json::array({1e-2, 1e-4}));
    EXPECT_EQ(back["chapters"][1]["plots"][0]["log_y"], false);
    EXPECT_EQ(back["chapters"][0]["paragraphs"][1], "2. No list");
}

TEST(StudyWriters, MarkdownAlignsItsColumns) {
    Table table{"t", "Title", {{"method", "Method"}, {"error", "Fehler Δ"}}, {}, "A note."};
    table.rows = {{"exact", 1.0 / 3.0}, {"größer", 1.5e-10}, {"none", std::monostate{}}};
    const std::string text = markdown_text({"R", {}, {{"C", {}, {table}, {}}}});
    EXPECT_EQ(text,
              "# R\n\n## C\n\n**Title**\n\n"
              "| Method | Fehler Δ |\n"
              "|--------|---------:|\n"
              "| exact  |    0.333 |\n"
              "| größer |  1.5e-10 |\n"
              "| none   |          |\n\n"
              "A note.\n");
}

TEST(StudyWriters, MarkdownEscapesAndNamesFailures) {
    const std::string text = markdown_text(small_report());
    EXPECT_THAT(text, HasSubstr("Plain a\\_b, \"q\" \\<b\\>\\&amp; \\| \\*x\\* 'y' \\`touch pwned\\`"));
    EXPECT_THAT(text, HasSubstr("\n2\\. No list\n"));
    EXPECT_THAT(text, HasSubstr("-O3 \\| -g"));
    EXPECT_THAT(text, HasSubstr(" 12345 | **failed:** it diverged |"));
    EXPECT_THAT(text, HasSubstr("| 0.333 |                         |"));
    EXPECT_THAT(text, HasSubstr("](error.svg)"));
}

TEST(StudyWriters, ColumnOfFailuresIsShownWhereThereAreSome) {
    Table table = small_table();
    EXPECT_THAT(markdown_text({"R", {}, {{"C", {}, {table}, {}}}}), HasSubstr("| Failure"));
    table.rows.pop_back();
    EXPECT_THAT(markdown_text({"R", {}, {{"C", {}, {table}, {}}}}), Not(HasSubstr("Failure")));
    EXPECT_THAT(html_text({"R", {}, {{"C", {}, {table}, {}}}}, {}), Not(HasSubstr("Failure")));
    EXPECT_THAT(csv_text(table), HasSubstr(",failure\n"));  // whoever reads files finds every key
}

TEST(StudyWriters, ScriptsQuoteEveryText) {
    const std::string script = gnuplot_script(small_plot(), PlotFormat::kSvg);
    EXPECT_THAT(script, HasSubstr("set title 'Error, a_b, \"q\" <b>&amp; | *x* ''y'' `touch pwned`"));
    EXPECT_THAT(script, HasSubstr("set logscale x\n"));
    EXPECT_THAT(script, HasSubstr("0.01 0.0001\nNaN NaN\nEND\n"));  // zero breaks the line, it is not moved
    EXPECT_THAT(script, HasSubstr("keyentry"));
    Plot linear = small_plot();
    linear.log_x = linear.log_y = false;
    EXPECT_THAT(gnuplot_script(linear, PlotFormat::kSvg),
                AllOf(HasSubstr("0.10000000000000001 0\nEND"), Not(HasSubstr("logscale"))));
}

TEST(StudyWriters, PlotsArePicturesOfTheRightSize) {
    const test::ScratchFolder folder;
    Plot empty = small_plot();
    empty.id = "empty";
    empty.series.clear();
    Plot nothing = small_plot();
    nothing.id = "nothing";
    nothing.series = {{"never", {{-1.0, 1.0}}}};
    Plot one = small_plot();
    one.id = "one";
    one.series = {{"one", {{1.0, 1.0}}}};
    for (const Plot& plot : {small_plot(), empty, nothing, one}) {
        const std::string png = folder.write(plot.id + ".png", draw_plot(plot, PlotFormat::kPng));
        const Image image = media::read_png(png);
        EXPECT_EQ(image.width(), 1200) << plot.id;
        EXPECT_EQ(image.height(), 800) << plot.id;
        const std::string svg = folder.write(plot.id + ".svg", draw_plot(plot, PlotFormat::kSvg));
        const auto result = run_shell("xmllint --noout --nonet " + test::quoted(svg));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_THAT(test::read_file(svg), HasSubstr("viewBox=\"0 0 1200 800\"")) << plot.id;
    }
    EXPECT_FALSE(std::filesystem::exists("pwned"));
    EXPECT_THAT(test::read_file(folder.file("error.svg")), HasSubstr("`touch pwned` $(touch pwned) @m \\"));
    EXPECT_THAT(test::read_file(folder.file("error.svg")), HasSubstr("never (nothing to draw)"));
}

TEST(StudyWriters, MissingGnuplotNamesItsPackage) {
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

TEST(StudyWriters, FailingGnuplotIsHeard) {
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
    EXPECT_EQ(code_of([] { check_gnuplot(); }), ExitCode::kIo);
    EXPECT_EQ(code_of([&] { write_report(small_report(), folder.file("out")); }), ExitCode::kIo);
    EXPECT_FALSE(std::filesystem::exists(folder.file("out")));  // nothing of it is written
}

TEST(StudyWriters, PageIsWellFormedAndNeedsNothingBesideIt) {
    const test::ScratchFolder folder;
    const std::string page =
        html_text(small_report(), [](const Plot& plot) { return draw_plot(plot, PlotFormat::kSvg); });
    const std::string path = folder.write("report.html", page);
    const auto result = run_shell("xmllint --noout --nonet --dropdtd " + test::quoted(path));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* forbidden :
         {"<script", "<link", "<img", "<iframe", "src=", "url(", "@import", "onload"}) {
        EXPECT_THAT(page, Not(HasSubstr(forbidden))) << forbidden;
    }
    // The only addresses are the names of XML's own vocabularies.
    for (std::size_t at = page.find("http"); at != std::string::npos; at = page.find("http", at + 1)) {
        EXPECT_THAT(page.substr(at, 24), testing::StartsWith("http://www.w3.org/"));
    }
    const auto twice =
        run_shell("grep -oE '\\bid=.[A-Za-z0-9_-]+' " + test::quoted(path) + " | sort | uniq -d");
    EXPECT_EQ(twice.out, "");  // ids are unique over all plots
}

TEST(StudyWriters, PageEscapesAndMarksFailures) {
    const std::string page = html_text(small_report(), [](const Plot&) { return "<svg></svg>\n"; });
    EXPECT_THAT(page, HasSubstr("<title>A &lt;study&gt;</title>"));
    EXPECT_THAT(page, HasSubstr("<h2><a href=\"#chapter-1\">1. First &amp; &lt;foremost&gt;</a></h2>"));
    EXPECT_THAT(page, HasSubstr("<p>Plain a_b, &quot;q&quot; &lt;b&gt;&amp;amp; | *x* &#39;y&#39;"));
    EXPECT_THAT(page, HasSubstr("<th scope=\"row\">Processor</th><td>Some &amp; any &lt;CPU&gt;</td>"));
    EXPECT_THAT(page, HasSubstr("<tr class=\"failed\"><td class=\"text\">rope</td>"));
    EXPECT_THAT(page, HasSubstr("title=\"1.0000000000000001e-05\">1·10<sup>−5</sup></td>"));
    EXPECT_THAT(page, HasSubstr("<td class=\"missing\">–</td>"));
    EXPECT_THAT(page, HasSubstr("aria-label=\"Error, a_b, &quot;q&quot;"));
    std::size_t failed = 0;
    for (std::size_t at = page.find("<tr class=\"failed\">"); at != std::string::npos;
         at = page.find("<tr class=\"failed\">", at + 1))
        ++failed;
    EXPECT_EQ(failed, 1U);  // an empty text is no failure
}

TEST(StudyWriters, ReportWritesEveryFileWhole) {
    const test::ScratchFolder folder;
    const std::string out = folder.file("some/out");
    const auto paths = write_report(small_report(), out);
    EXPECT_THAT(paths, ElementsAre(out + "/report.html", out + "/report.json", out + "/report.md",
                                   out + "/linear.png", out + "/linear.svg", out + "/error.png",
                                   out + "/error.svg", out + "/speed.csv"));
    for (const std::string& path : paths) EXPECT_GT(std::filesystem::file_size(path), 0U) << path;
    EXPECT_EQ(test::read_file(out + "/speed.csv"), csv_text(small_table()));
    EXPECT_EQ(test::read_file(out + "/report.json"), json_text(small_report()));
    const auto parts = run_shell("ls " + test::quoted(out) + " | grep part");
    EXPECT_EQ(parts.out, "");
    EXPECT_EQ(code_of([&] { write_report(small_report(), paths[0]); }), ExitCode::kIo);  // a file, no folder
}

TEST(StudyWriters, BrokenReportsAreRefused) {
    EXPECT_NO_THROW(check_report(small_report()));
    const auto code_with = [](const std::function<void(Report&)>& change) {
        Report report = small_report();
        change(report);
        return code_of([&report] { check_report(report); });
    };
    EXPECT_EQ(code_with([](Report& r) { r.chapters[0].tables[0].id = "../x"; }), ExitCode::kInternal);
    EXPECT_EQ(code_with([](Report& r) { r.chapters[0].tables[0].id = ""; }), ExitCode::kInternal);
    EXPECT_EQ(code_with([](Report& r) { r.chapters[1].plots[0].id = "error"; }), ExitCode::kInternal);
    EXPECT_EQ(code_with([](Report& r) { r.chapters[0].tables[0].rows[1].pop_back(); }), ExitCode::kInternal);
    EXPECT_EQ(code_with([](Report& r) { r.chapters[0].tables[0].columns[1].key = "method"; }),
              ExitCode::kInternal);
}

TEST(StudySetting, NamesTheProcessor) {
    EXPECT_EQ(processor_name("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2.1 GHz\nflags: x\n"),
              "Some CPU @ 2.1 GHz");
    EXPECT_EQ(processor_name("processor : 0\nHardware : Board\n"), "Board");
    EXPECT_EQ(processor_name(""), "unknown");
    const auto pairs = setting({7, 0.04});
    ASSERT_EQ(pairs.size(), 6U);
    for (const auto& [name, value] : pairs) EXPECT_NE(value, "") << name;
    EXPECT_THAT(pairs[5].second, HasSubstr("at least 7 repeats, each of at least 40 ms"));
    EXPECT_THAT(pairs[3].second, HasSubstr("-ffp-contract=off"));
}

}  // namespace
}  // namespace corda::study
