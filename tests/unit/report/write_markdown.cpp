#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "samples.hpp"

namespace corda::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Markdown, AlignsItsColumns) {
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

TEST(Markdown, EscapesAndNamesFailures) {
    const std::string text = markdown_text(small_report());
    EXPECT_THAT(text, HasSubstr("Plain a\\_b, \"q\" \\<b\\>\\&amp; \\| \\*x\\* 'y' \\`touch pwned\\`"));
    EXPECT_THAT(text, HasSubstr("\n2\\. No list\n"));
    EXPECT_THAT(text, HasSubstr("-O3 \\| -g"));
    EXPECT_THAT(text, HasSubstr(" 12345 | **failed:** it diverged |"));
    EXPECT_THAT(text, HasSubstr("| 0.333 |                         |"));
    EXPECT_THAT(text, HasSubstr("](error.svg)"));
}

}  // namespace
}  // namespace corda::report
