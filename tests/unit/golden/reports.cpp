#include "corda/golden/suite.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace corda::golden {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Checked picture(const std::string& name, Verdict verdict, const std::string& group = "") {
    Checked one{.scene = "swing", .name = name, .verdict = verdict};
    one.group = group;
    one.seconds = 0.25;
    return one;
}

TEST(GoldenTotals, CountEachPictureOnce) {
    SuiteResult result;
    for (const Verdict verdict : {Verdict::kPassed, Verdict::kDifferent, Verdict::kEmpty, Verdict::kMissing,
                                  Verdict::kStale, Verdict::kStale, Verdict::kInvalid})
        result.pictures.push_back(picture("a.png", verdict));
    EXPECT_EQ(result.totals(), "6 pictures: 1 passed, 2 failed, 1 missing, 2 stale; 1 scene invalid");
    result.may_change = true;
    result.pictures[0].changed = result.pictures[1].changed = result.pictures[4].changed = true;
    EXPECT_EQ(result.totals(),
              "6 pictures: 0 passed, 1 failed, 1 missing, 1 stale, 3 written or removed; 1 scene invalid");
    result.dry_run = true;
    EXPECT_THAT(result.totals(), HasSubstr(", 3 would be written or removed"));
}

TEST(GoldenMarkdown, HasATablePerCauseAndEscapesText) {
    SuiteResult result;
    result.pictures = {picture("a.png", Verdict::kDifferent, "world.drag is 0.2 and was 0"),
                       picture("b|<i>.png", Verdict::kMissing, "there is no reference"),
                       picture("c.png", Verdict::kDifferent, "world.drag is 0.2 and was 0"),
                       picture("d.png", Verdict::kPassed)};
    result.pictures[0].cause = "positions differ by 1 m; world.drag is 0.2 and was 0";
    EXPECT_EQ(
        markdown(result),
        "### Golden pictures\n\n4 pictures: 1 passed, 2 failed, 1 missing, 0 stale\n"
        "\n**there is no reference**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n"
        "| b\\|&lt;i&gt;.png | missing |  |  |\n"
        "\n**world.drag is 0.2 and was 0**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n"
        "| a.png | different |  | positions differ by 1 m |\n| c.png | different |  |  |\n");
}

TEST(GoldenMarkdown, FitsIntoAComment) {
    SuiteResult result;
    for (int i = 0; i < 300; ++i) {
        result.pictures.push_back(picture("swing_t0000_000000.png", Verdict::kDifferent, "positions differ"));
        result.pictures.back().cause = "positions differ by 0.00031 m, from t = 0.5 s on";
        result.pictures.back().reference = "a";
    }
    EXPECT_LT(markdown(result).size(), 65536U);  // 26 kB
    EXPECT_THAT(markdown(result), HasSubstr("\nand 100 more\n"));
}

TEST(GoldenJunit, HasTimesAndFigures) {
    SuiteResult result;
    result.pictures = {picture("a.png", Verdict::kPassed),
                       picture("b.png", Verdict::kDifferent, "pixels differ"),
                       picture("c.toml", Verdict::kInvalid, "invalid scene")};
    result.pictures[1].reference = "ref/b.png";
    result.pictures[1].difference = {.equal = false, .max = 3.0, .mean = 0.5, .share = 0.25};
    EXPECT_THAT(
        junit_xml(result),
        AllOf(HasSubstr("<testsuite name=\"swing\" tests=\"3\" failures=\"1\" errors=\"1\" time=\"0.750\">"),
              HasSubstr("<testcase classname=\"swing\" name=\"b.png\" time=\"0.250\">"),
              HasSubstr("<property name=\"share\" value=\"0.25\"/>"),
              HasSubstr("<failure type=\"different\" message=\"max 3, mean 0.5, share 0.25; "
                        "pixels differ\"/>"),
              HasSubstr("<error type=\"invalid\" message=\"invalid scene\"/>")));
}

}  // namespace
}  // namespace corda::golden
