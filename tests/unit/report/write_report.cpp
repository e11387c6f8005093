#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "samples.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::report {
namespace {

using testing::ElementsAre;

TEST(WriteReport, WritesEveryFile) {
    const test::ScratchFolder folder;
    const std::string out = folder.file("some/out");
    const auto paths = write_report(small_report(), out);
    EXPECT_THAT(paths, ElementsAre(out + "/report.html", out + "/report.json", out + "/report.md",
                                   out + "/linear.png", out + "/linear.svg", out + "/error.png",
                                   out + "/error.svg", out + "/speed.csv"));
    for (const std::string& path : paths) EXPECT_GT(std::filesystem::file_size(path), 0U) << path;
    EXPECT_EQ(test::read_file(out + "/speed.csv"), csv_text(small_table()));
    EXPECT_EQ(test::read_file(out + "/report.json"), json_text(small_report()));
    const std::filesystem::directory_iterator files(out);
    EXPECT_EQ(std::distance(begin(files), end(files)), std::ssize(paths));  // no temporary ones are left
    const std::string& file = paths[0];
    EXPECT_EQ(test::code_of([&] { write_report(small_report(), file); }), ExitCode::kIo);
}

TEST(WriteReport, ReplacesFilesOnlyIfForced) {
    const test::ScratchFolder folder;
    Report report = small_report();
    report.chapters.pop_back();
    write_report(report, folder.path());
    const std::string other = folder.write("other.csv", "mine");
    EXPECT_EQ(test::code_of([&] { write_report(report, folder.path()); }), ExitCode::kIo);
    report.title = "Changed";
    write_report(report, folder.path(), {.force = true});
    EXPECT_EQ(test::read_file(folder.file("report.json")), json_text(report));
    EXPECT_EQ(test::read_file(other), "mine");
}

}  // namespace
}  // namespace corda::report
