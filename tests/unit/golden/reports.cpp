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

using Kind = Cause::Kind;

Checked picture(const std::string& name, const Cause& cause = {}, bool is_empty = false) {
    return {.scene = "swing", .name = name, .is_empty = is_empty, .cause = cause, .seconds = 0.25};
}

const KeyChange kDrag{.key = "world.drag", .now = "0.2", .before = "0"};
const KeyChange kCamera{.key = "camera.height", .now = "3", .before = "2"};

TEST(GoldenCauses, NameTheSceneBeforeWhatFollows) {
    const Cause drag{.kind = Kind::kScene, .changed = {kDrag}, .chosen = {kCamera}};
    const Cause camera{.kind = Kind::kChoice, .chosen = {kCamera}};
    const Cause size{.kind = Kind::kSize, .stored = "8x6", .now = "4x3"};
    const Cause damage{.kind = Kind::kReferenceIsDamaged, .message = "it ends"};
    const std::string changed = "world.drag is 0.2 and was 0";
    const std::string chosen = "another choice: camera.height is 3 and was 2";
    const struct {
        Verdict verdict;
        Cause cause;
        std::string group;
        std::string whole;
    } cases[] = {
        {Verdict::kDifferent, drag, changed, changed + "; " + chosen},
        {Verdict::kEmpty, drag, changed, "nothing is in view; " + changed + "; " + chosen},
        {Verdict::kEmpty, {}, "nothing is in view", "nothing is in view"},
        {Verdict::kEmpty, {.kind = Kind::kNoReference}, "there is no reference", "nothing is in view"},
        {Verdict::kMissing, {.kind = Kind::kNoReference}, "there is no reference", ""},
        {Verdict::kDifferent, camera, "another solver or camera is chosen", "same scene, " + chosen},
        {Verdict::kDifferent, size, "8x6 pixels, now 4x3", "8x6 pixels, now 4x3"},
        {Verdict::kDifferent, damage, "is damaged, and --update replaces it",
         "the kept picture is damaged, and --update replaces it (it ends)"},
        {Verdict::kStale,
         {.kind = Kind::kUnaskedUnrecorded},
         "no scene asks for it",
         "no scene asks for it; it has no record of how it was made, and --update --force removes it"},
    };
    for (const auto& [verdict, cause, group, whole] : cases) {
        const Checked checked = picture("a.png", cause, verdict == Verdict::kEmpty);
        EXPECT_EQ(checked.verdict(), verdict);
        const CauseText text = cause_text(checked);
        EXPECT_EQ(text.group, group);
        EXPECT_EQ(text.whole, whole);
    }
}

TEST(GoldenTotals, CountEachPictureOnce) {
    SuiteResult result;
    for (const Kind kind : {Kind::kNone, Kind::kPixels, Kind::kNone, Kind::kNoReference, Kind::kUnasked,
                            Kind::kUnaskedNoPng, Kind::kInvalidScene})
        result.pictures.push_back(picture("a.png", {.kind = kind}));
    result.pictures[2].is_empty = true;
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
    const Cause drag{.kind = Kind::kScene, .changed = {kDrag}, .chosen = {kCamera}};
    result.pictures = {picture("a.png", drag), picture("b|<i>.png", {.kind = Kind::kNoReference}),
                       picture("c.png", {.kind = Kind::kScene, .changed = {kDrag}}), picture("d.png")};
    EXPECT_EQ(
        markdown(result),
        "### Golden pictures\n\n4 pictures: 1 passed, 2 failed, 1 missing, 0 stale\n"
        "\n**there is no reference**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n"
        "| b\\|&lt;i&gt;.png | missing |  |  |\n"
        "\n**world.drag is 0.2 and was 0**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n"
        "| a.png | different |  | another choice: camera.height is 3 and was 2 |\n| c.png | different |  |  "
        "|\n");
}

TEST(GoldenMarkdown, FitsIntoAComment) {
    SuiteResult result;
    for (int i = 0; i < 300; ++i) {
        result.pictures.push_back(picture("swing_t0000_000000.png",
                                          {.kind = Kind::kScene, .changed = {kDrag}, .chosen = {kCamera}}));
        result.pictures.back().difference =
            Difference{.equal = false, .max = 3.0, .mean = 0.5, .share = 0.25};
    }
    EXPECT_LT(markdown(result).size(), 65536U);  // 26 kB
    EXPECT_THAT(markdown(result), HasSubstr("\nand 100 more\n"));
}

TEST(GoldenJunit, HasTimesAndFigures) {
    SuiteResult result;
    result.pictures = {picture("a.png"), picture("b.png", {.kind = Kind::kUnrecorded}),
                       picture("c.toml", {.kind = Kind::kInvalidScene})};
    result.pictures[1].difference = Difference{.equal = false, .max = 3.0, .mean = 0.5, .share = 0.25};
    EXPECT_THAT(
        junit_xml(result),
        AllOf(HasSubstr("<testsuite name=\"swing\" tests=\"3\" failures=\"1\" errors=\"1\" time=\"0.750\">"),
              HasSubstr("<testcase classname=\"swing\" name=\"b.png\" time=\"0.250\">"),
              HasSubstr("<property name=\"share\" value=\"0.25\"/>"),
              HasSubstr("<failure type=\"different\" message=\"max 3, mean 0.5, share 0.25; "
                        "pixels differ; the reference does not say how it was made\"/>"),
              HasSubstr("<error type=\"invalid\" message=\"invalid scene\"/>")));
}

}  // namespace
}  // namespace corda::golden
