#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "samples.hpp"
#include "support/command.hpp"

namespace corda::report {
namespace {

using test::run_shell;
using testing::HasSubstr;
using testing::Not;

Plot plot_of(const std::string& id) {
    for (const Chapter& chapter : small_report().chapters) {
        for (const Plot& plot : chapter.plots)
            if (plot.id == id) return plot;
    }
    return {};
}

TEST(Html, PageIsWellFormedAndNeedsNoOtherFile) {
    const test::ScratchFolder folder;
    const std::string page = html_text(small_report(), [](const std::string& id) {
        return draw_plot(plot_of(id), PlotFormat::kSvg, kPageMm);
    });
    const std::string path = folder.write("report.html", page);
    const auto result = run_shell("xmllint --noout --nonet --dropdtd " + test::quoted(path));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* forbidden : {"<script", "<link", "<iframe", "src=\"h", "url(", "@import", "onload"}) {
        EXPECT_THAT(page, Not(HasSubstr(forbidden))) << forbidden;
    }
    // The only addresses are the names of XML vocabularies.
    for (std::size_t at = page.find("http"); at != std::string::npos; at = page.find("http", at + 1)) {
        EXPECT_THAT(page.substr(at, 24), testing::StartsWith("http://www.w3.org/"));
    }
    const auto twice =
        run_shell("grep -oE '\\bid=.[A-Za-z0-9_-]+' " + test::quoted(path) + " | sort | uniq -d");
    EXPECT_EQ(twice.out, "");  // ids are unique over all plots
}

TEST(Html, PageEscapesAndMarksFailures) {
    const std::string page = html_text(small_report(), [](const std::string&) { return "<svg></svg>\n"; });
    EXPECT_THAT(page, HasSubstr("<title>A &lt;report&gt;</title>"));
    EXPECT_THAT(page, HasSubstr("<h2><a href=\"#chapter-1\">1. First &amp; &lt;foremost&gt;</a></h2>"));
    EXPECT_THAT(page, HasSubstr("<p>Plain a_b, &quot;q&quot; &lt;b&gt;&amp;amp; | *x* 'y'"));
    EXPECT_THAT(page, HasSubstr("<th scope=\"row\">Processor</th><td>Some &amp; any &lt;CPU&gt;</td>"));
    EXPECT_THAT(page, HasSubstr("<tr class=\"failed\"><td class=\"text\">rattle</td>"));
    EXPECT_THAT(page, HasSubstr("title=\"1.0000000000000001e-05\">1·10<sup>−5</sup></td>"));
    EXPECT_THAT(page, HasSubstr("<td class=\"missing\">–</td>"));
    EXPECT_THAT(page, HasSubstr("<img alt=\"Error, a_b, &quot;q&quot;"));
    EXPECT_THAT(page, HasSubstr("src=\"data:image/svg+xml;base64,PHN2Zz48L3N2Zz4K\"/>"));
    std::size_t failed = 0;
    for (std::size_t at = page.find("<tr class=\"failed\">"); at != std::string::npos;
         at = page.find("<tr class=\"failed\">", at + 1))
        ++failed;
    EXPECT_EQ(failed, 1U);  // an empty text is not a failure
}

}  // namespace
}  // namespace corda::report
