#include "corda/report/writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>

#include "corda/core/basics.hpp"

namespace corda::report {
namespace {

using testing::HasSubstr;

TEST(Child, ReadsItsInputAndReturnsItsOutput) {
    const std::string much(1 << 20, 'x');  // more than a pipe holds
    const ChildResult result = run_child({"cat"}, much, "");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out, much);
    EXPECT_EQ(result.err, "");
}

TEST(Child, ArgumentsAreNotParsedByAShell) {
    EXPECT_EQ(run_child({"printf", "%s", "$(echo a) * 'b'"}, "", "").out, "$(echo a) * 'b'");
}

TEST(Child, StatusIsThatOfTheProgram) {
    const ChildResult failed = run_child({"sh", "-c", "echo reason >&2; exit 3"}, "", "");
    EXPECT_EQ(failed.exit_code, 3);
    EXPECT_EQ(failed.err, "reason\n");
    EXPECT_EQ(run_child({"sh", "-c", "kill -TERM $$"}, "", "").exit_code, 128 + SIGTERM);
}

TEST(Child, IsNotEndedBySignalsForThisProcessGroup) {
    const ChildResult result = run_child({"sh", "-c", "ps -o pgid= -p $$; echo $$"}, "", "");
    int group = 0;
    int process = 0;
    ASSERT_EQ(std::sscanf(result.out.c_str(), "%d %d", &group, &process), 2) << result.out << result.err;
    EXPECT_EQ(group, process);
}

TEST(Child, EndsAtABrokenPipeEvenIfThisProgramIgnoresIt) {
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    const ChildResult result = run_child({"sh", "-c", "kill -PIPE $$; echo ignored"}, "", "");
    std::signal(SIGPIPE, before);
    EXPECT_EQ(result.exit_code, 128 + SIGPIPE);
    EXPECT_EQ(result.out, "");
}

TEST(Child, MissingProgramIsAnErrorWithTheHint) {
    try {
        static_cast<void>(run_child({"no-such-program"}, "", "install it"));
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kIo);
        EXPECT_THAT(error.what(), HasSubstr("no-such-program does not start"));
        EXPECT_THAT(error.what(), HasSubstr("install it"));
    }
}

}  // namespace
}  // namespace corda::report
