#include "corda/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "own_problems.hpp"
#include "support/failure.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

using testing::HasSubstr;

/// The message of the error that a study with this definition ends with.
std::string refusal_of(const StudyDef& def) {
    try {
        const Study study(def);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return "no error";
}

TEST(Study, OfASceneShowsFailedRunsAndFillsItsTables) {
    StudyDef def;
    def.quick = true;
    def.scene = scene_with(test::ring(6), 0.1);
    def.chapters = {"speed"};
    int calls = 0;
    int left = -1;
    Study study(def);
    int chapters = 0;
    report::Report report;
    study.run(
        [&](int done, int total, const std::string& what) {
            EXPECT_EQ(done, calls);
            EXPECT_FALSE(what.empty());
            ++calls;
            left = total - done;
        },
        [&](const report::Chapter& chapter) {
            ++chapters;
            EXPECT_EQ(chapter.title, "Speed against error");
            EXPECT_EQ(left, 1);
        },
        report);
    EXPECT_EQ(chapters, 1);
    EXPECT_GT(calls, 10);
    EXPECT_EQ(left, 0);
    EXPECT_THAT(report.title, HasSubstr("Own rope-1"));
    EXPECT_GE(report.setting.size(), 6U);
    ASSERT_EQ(report.chapters.size(), 1U);
    std::set<std::string> ids;
    bool has_failed_row = false;
    for (const report::Table& table : report.chapters[0].tables) {
        EXPECT_TRUE(ids.insert(table.id).second) << table.id;
        for (const auto& row : table.rows) {
            ASSERT_EQ(row.size(), table.columns.size()) << table.id;
            const auto* text = std::get_if<std::string>(&row.back());
            if (table.columns.back().key != report::kFailureKey || text == nullptr) continue;
            has_failed_row = true;
            EXPECT_EQ(std::get<std::string>(row[0]), "exact");
        }
    }
    EXPECT_TRUE(has_failed_row);  // exact refuses a closed rope
}

TEST(Study, EndsWithTheChaptersBeforeWhatEndsIt) {
    StudyDef def;
    def.quick = true;
    def.chapters = {"findings", "hard_cases"};
    bool ends = false;
    Study study(def);
    const CancelScope stop([&ends] {
        if (ends) throw Error(ExitCode::kTerminated, "stopped");
    });
    report::Report report;
    const auto run = [&] {
        study.run(
            {}, [&](const report::Chapter&) { ends = true; }, report);
    };
    EXPECT_EQ(test::code_of(run), ExitCode::kTerminated);
    ASSERT_EQ(report.chapters.size(), 1U);
    using Row = std::pair<std::string, std::string>;
    EXPECT_EQ(report.setting[report.setting.size() - 2], Row("Ends early", "stopped"));
    EXPECT_EQ(report.setting.back(), Row("Not measured", "hard_cases"));
}

TEST(Study, NamesUnknownAndUnsuitableChapters) {
    StudyDef def;
    def.chapters = {"colours"};
    EXPECT_EQ(refusal_of(def),
              "there is no chapter \"colours\"; known are speed, findings, accuracy, hard_cases");
    def.chapters = {"hard_cases"};
    def.scene = scene_with(reference::straight_rope(5, 1.0, 30.0), 0.1);
    EXPECT_THAT(refusal_of(def), HasSubstr("chapter \"hard_cases\" is about built-in problems"));
    for (const std::string& name : chapter_names())
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos);
}

TEST(Setting, NamesTheProcessor) {
    std::istringstream cpuinfo("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2.1 GHz\nflags: x\n");
    EXPECT_EQ(processor_name(cpuinfo), "Some CPU @ 2.1 GHz");
    std::istringstream other("processor : 0\n");
    EXPECT_EQ(processor_name(other), "unknown");
}

TEST(Setting, HasNoEmptyValues) {
    const auto pairs = setting({7, 0.04});
    ASSERT_EQ(pairs.size(), 6U);
    for (const auto& [name, value] : pairs) EXPECT_NE(value, "") << name;
    EXPECT_THAT(pairs[5].second, HasSubstr("7 repeats of at least 40 ms"));
    EXPECT_THAT(pairs[3].second, HasSubstr("-ffp-contract=off"));
}

}  // namespace
}  // namespace corda::study
