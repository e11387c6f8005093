#include "corda/report/report_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/markup.hpp"
#include "samples.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::report {
namespace {

using test::code_of;
using test::run_shell;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Writes a report at once and returns its paths.
std::vector<std::string> write(const Report& report, const std::string& path, OutputOptions options = {}) {
    ReportFolder folder(path, std::move(options));
    for (const Chapter& chapter : report.chapters) folder.add(chapter);
    folder.finish(report);
    return folder.paths();
}

TEST(ReportFolder, GetsEveryFile) {
    const test::ScratchFolder folder;
    const std::string out = folder.file("some/out");
    const auto paths = write(small_report(), out);
    EXPECT_THAT(paths, ElementsAre(out + "/report.html", out + "/setting.csv", out + "/linear.pdf",
                                   out + "/linear.png", out + "/linear.svg", out + "/error.pdf",
                                   out + "/error.png", out + "/error.svg", out + "/speed.csv"));
    for (const std::string& path : paths) EXPECT_GT(std::filesystem::file_size(path), 0U) << path;
    EXPECT_EQ(test::read_file(out + "/speed.csv"), csv_text(small_table()));
    EXPECT_EQ(test::read_file(out + "/setting.csv"),
              "name,value\nProcessor,Some & any <CPU>\nBuild,-O3 | -g\n");
    const std::filesystem::directory_iterator files(out);
    EXPECT_EQ(std::distance(begin(files), end(files)), std::ssize(paths));  // no temporary ones are left
    const std::string& file = paths[0];
    EXPECT_EQ(code_of([&] { write(small_report(), file); }), ExitCode::kIo);
}

TEST(ReportFolder, ReplacesFilesOnlyIfForced) {
    const test::ScratchFolder folder;
    Report report = small_report();
    report.chapters.pop_back();
    write(report, folder.path());
    const std::string other = folder.write("other.csv", "mine");
    EXPECT_EQ(code_of([&] { write(report, folder.path()); }), ExitCode::kIo);
    report.title = "Changed";
    write(report, folder.path(), {.force = true});
    EXPECT_THAT(test::read_file(folder.file("report.html")), HasSubstr("<h1>Changed</h1>"));
    EXPECT_EQ(test::read_file(other), "mine");
}

TEST(ReportFolder, HasAChapterAsSoonAsItIsAdded) {
    const test::ScratchFolder folder;
    ReportFolder report(folder.path());
    report.add(small_report().chapters[0]);
    EXPECT_THAT(folder.files(), ElementsAre("error.pdf", "error.png", "error.svg", "speed.csv"));
}

TEST(ReportFolder, IsFinishedWithThePicturesThatWereDrawn) {
    const test::ScratchFolder folder;
    const Report whole = small_report();
    ReportFolder report(folder.path());
    {
        bool is_first = true;
        const CancelScope stop([&is_first] { return is_first; });
        report.add(whole.chapters[0]);
        is_first = false;
        EXPECT_EQ(code_of([&] { report.add(whole.chapters[1]); }), ExitCode::kInterrupted);
    }
    report.finish(whole);
    EXPECT_THAT(folder.files(), ElementsAre("error.pdf", "error.png", "error.svg", "report.html",
                                            "setting.csv", "speed.csv"));
    const std::string page = test::read_file(folder.file("report.html"));
    EXPECT_THAT(page, HasSubstr("Second"));
    EXPECT_THAT(page, Not(HasSubstr("figure-linear")));
}

/// A report whose pictures record the order in which they were written.
Report drawn_report() {
    const auto write = [](const std::string& path, double width_mm) {
        test::write_file(path, "<svg>" + std::to_string(width_mm) + "</svg>\n");
    };
    Report report{"R", {}, {{"C", {}, {}, {}, "", {}}}};
    report.chapters[0].pictures = {{"whole", "a \"whole\"", "All <of> it.", write},
                                   {"part", "part", "A part.", write, true},
                                   {"other", "other", "Another.", write, true}};
    return report;
}

TEST(ReportFolder, GetsPicturesOfEachWidth) {
    const test::ScratchFolder scratch;
    ReportFolder folder(scratch.path(), {}, {85, 170});
    Report report = drawn_report();
    folder.add(report.chapters[0]);
    test::write_file(folder.path_of("rows.csv"), "t\n");
    folder.note(folder.path_of("rows.csv"));
    folder.finish(report);
    EXPECT_EQ(folder.paths().size(), 3U * 6U + 1U + 2U);
    EXPECT_EQ(scratch.files().size(), folder.paths().size());
    EXPECT_TRUE(std::filesystem::exists(scratch.file("whole_85mm.png")));
    const std::string page = test::read_file(scratch.file("report.html"));
    const auto address = [](const char* svg) { return ";base64," + base64(svg) + "\"/>"; };
    EXPECT_THAT(page,
                HasSubstr("<figure id=\"figure-whole\">\n<img alt=\"a &quot;whole&quot;\" src=\"data:"));
    EXPECT_THAT(page, HasSubstr(address("<svg>170.000000</svg>\n")));
    EXPECT_THAT(page, HasSubstr("<b>Figure 1.</b> All &lt;of&gt; it.<span class=\"files\">85 mm: <a "
                                "href=\"whole_85mm.svg\">SVG</a> <a href=\"whole_85mm.pdf\">PDF</a>"));
    EXPECT_THAT(page, HasSubstr("<div class=\"small\">\n<figure id=\"figure-part\">"));
    EXPECT_THAT(page, HasSubstr(address("<svg>85.000000</svg>\n")));  // narrow pictures are small
    EXPECT_THAT(page, HasSubstr("<b>Figure 3.</b> Another."));
}

TEST(ReportFolder, IsWellFormedWhateverATextIs) {
    const test::ScratchFolder folder;
    const std::vector<std::string> texts{"'x",
                                         "'",
                                         "''",
                                         "a''b'''c",
                                         "]]>",
                                         "<!-- --> <?x?> <![CDATA[ &x;",
                                         "\x1b[31m\x07\n\t\x7f",
                                         "caf\xe9",
                                         "\xef\xbf\xbe \xed\xa0\x80 \xf4\x90\x80\x80",
                                         "a\\",
                                         "\"",
                                         "END\n",
                                         "",
                                         "`touch pwned` @x $x %s {/=20 x}",
                                         nasty};
    Report report{"", {}, {{"", {}, {}, {}}}};
    Chapter& chapter = report.chapters[0];
    for (const std::string& text : texts) {
        const std::string id = "id" + std::to_string(chapter.plots.size());
        chapter.paragraphs.push_back(text);
        chapter.tables.push_back({id, text, {{"key", text}, failure_column()}, {}, text});
        chapter.tables.back().add_failed({text}, text);
        const std::vector<Series> series{{text, {{0.0, 1.0}, {1.0, 2.0}}}, {text, {}}};
        chapter.plots.push_back({id, text, text, text, false, false, series});
        report.setting.emplace_back(text, text);
        report.title += text;
        chapter.title += text;
    }
    write(report, folder.path());
    const std::string enter = "cd " + folder.path() + " && ";
    const auto html = run_shell(enter + "xmllint --noout --nonet --dropdtd report.html");
    EXPECT_EQ(html.exit_code, 0) << html.err;
    const auto svgs = run_shell(enter + "xmllint --noout --nonet *.svg");
    EXPECT_EQ(svgs.exit_code, 0) << svgs.err;
    const auto utf8 = run_shell(enter + "cat *.csv *.html *.svg | iconv -f UTF-8 -t UTF-16");
    EXPECT_EQ(utf8.exit_code, 0) << utf8.err;
    EXPECT_THAT(test::read_file(folder.file("id7.csv")), HasSubstr("caf\\xe9,caf\\xe9\n"));
    EXPECT_FALSE(std::filesystem::exists("pwned"));
}

}  // namespace
}  // namespace corda::report
