#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "samples.hpp"

namespace corda::report {
namespace {

using nlohmann::json;

TEST(Csv, QuotesAndKeepsEveryDigit) {
    const std::string text = csv_text(small_table());
    EXPECT_EQ(text,
              "method,step_s,error,failure\n"
              "exact,0.10000000000000001,0.33333333333333331,\n"
              "\"a_b, \"\"q\"\" <b>&amp; | *x* 'y' `touch pwned` $(touch pwned) @m \\\","
              "1.0000000000000001e-05,,\n"
              "rattle,0.25,12345,it diverged\n");
    const Table lines{"t", "", {{"k", ""}}, {{"a\nb"}, {"a\rb"}, {""}}, ""};
    EXPECT_EQ(csv_text(lines), "k\n\"a\nb\"\n\"a\rb\"\n\n");
}

TEST(Json, HoldsTheWholeReport) {
    Report report = small_report();
    report.chapters[0].tables[0].rows[0][2] = kInfinity;
    const json back = json::parse(json_text(report));
    EXPECT_EQ(back["schema"], 1);
    EXPECT_EQ(back["title"], "A <report>");
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

TEST(Json, EscapesBytesThatItCannotHold) {
    Report report = small_report();
    report.title = "caf\xe9 \x1b";
    report.chapters[0].tables[0].rows[0][0] = "\xff";
    const json back = json::parse(json_text(report));
    EXPECT_EQ(back["title"], "caf\\xe9 \x1b");
    EXPECT_EQ(back["chapters"][0]["tables"][0]["rows"][0]["method"], "\\xff");
}

}  // namespace
}  // namespace corda::report
