#include "corda/core/child_process.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <vector>

#include "corda/core/machine.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using testing::HasSubstr;

constexpr ChildLimits kLimits{std::uint64_t{1} << 30, 20, 20.0};

/// Whether this process has a child left, running or not yet waited for.
bool has_child() {
    return waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD;
}

/// The error that ended the work.
std::string end_of(const std::function<std::string()>& work, const ChildLimits& limits = kLimits) {
    const auto end = run_in_child(work, limits);
    EXPECT_TRUE(end && !end->finished());
    EXPECT_FALSE(has_child());
    return end ? end->text : "";
}

TEST(ChildProcess, ReturnsTheResultOfTheWork) {
    const std::string much(1 << 20, '\0');  // more than a pipe holds
    const auto end = run_in_child([&] { return much; }, kLimits);
    ASSERT_TRUE(end);
    EXPECT_TRUE(end->finished());
    EXPECT_EQ(end->text, much);
    EXPECT_FALSE(has_child());
}

TEST(ChildProcess, ReportsHowTheWorkCrashed) {
    EXPECT_EQ(end_of([]() -> std::string { std::abort(); }), "crashed (Aborted)");
    EXPECT_EQ(end_of([]() -> std::string { throw 1; }), "crashed (status 1)");
    EXPECT_EQ(end_of([]() -> std::string { _exit(0); }), "crashed (status 0)");
    EXPECT_EQ(run_in_child([]() -> std::string { std::abort(); }, kLimits)->outcome,
              ChildEnd::Outcome::kCrashed);
}

TEST(ChildProcess, PassesOnAnErrorOfTheWork) {
    const test::Failure failure = test::failure_of([] {
        (void)run_in_child([]() -> std::string { throw Error(ExitCode::kMismatch, "x \xff y\nz"); }, kLimits);
    });
    EXPECT_EQ(failure.code, ExitCode::kMismatch);
    EXPECT_EQ(failure.message, "x \xff y\nz");
    EXPECT_EQ(run_in_child([] { return std::string(); }, kLimits)->text, "");
}

TEST(ChildProcess, IsLimitedInMemory) {
    const auto take = [] { return std::to_string(std::vector<char>(std::size_t{1} << 28, 'x').back()); };
    EXPECT_TRUE(run_in_child(take, kLimits)->finished());
    const auto end = run_in_child(take, {std::uint64_t{1} << 26, 20, 20.0});
#ifdef CORDA_SANITIZE  // AddressSanitizer ends the child in place of an exception
    EXPECT_EQ(end->outcome, ChildEnd::Outcome::kCrashed);
#else
    EXPECT_EQ(end->outcome, ChildEnd::Outcome::kOutOfMemory);
    EXPECT_EQ(end->text, "asks for more memory than it may have");
#endif
}

TEST(ChildProcess, IsLimitedInTime) {
    const auto spin = [] {
        while (now_s() >= 0.0) {
        }
        return std::string("done");
    };
    EXPECT_EQ(end_of(spin, {kLimits.memory_bytes, 1, 20.0}), "took more than 1 s of computing");
    const double start_s = now_s();
    const auto sleep = [] { return std::to_string(::sleep(60)); };
    const ChildLimits short_wait{kLimits.memory_bytes, 20, 0.3};
    EXPECT_EQ(end_of(sleep, short_wait), "did not end within 0.3 s");
    EXPECT_EQ(run_in_child(sleep, short_wait)->outcome, ChildEnd::Outcome::kTimedOut);
    EXPECT_LT(now_s() - start_s, 10.0);
}

TEST(ChildProcess, IsKilledIfTheWaitIsCancelled) {
    const double start_s = now_s();
    const auto sleep = [] { return std::to_string(::sleep(60)); };
    const CancelScope stop([&] {
        if (now_s() > start_s + 0.2) throw Error(ExitCode::kTerminated, "stopped");
    });
    EXPECT_EQ(test::code_of([&] { (void)run_in_child(sleep, kLimits); }), ExitCode::kTerminated);
    EXPECT_FALSE(has_child());
    EXPECT_LT(now_s() - start_s, 10.0);
}

TEST(ChildProcess, KilledFromOutsideIsNotACrash) {
    for (const int signal : {SIGKILL, SIGTERM}) {
        const test::Failure failure = test::failure_of([signal] {
            (void)run_in_child([signal] { return std::to_string(std::raise(signal)); }, kLimits);
        });
        EXPECT_EQ(failure.code, ExitCode::kTemporary) << signal;
        EXPECT_THAT(failure.message, HasSubstr("ended from outside"));
    }
    // A signal to the process group reaches both.
    const CancelScope stop = test::cancel_after(1);
    const auto work = [] { return std::to_string(std::raise(SIGINT)); };
    EXPECT_EQ(test::code_of([&] { (void)run_in_child(work, kLimits); }), ExitCode::kInterrupted);
}

}  // namespace
}  // namespace corda
