#pragma once

/// Golden pictures in GoogleTest:
///
///     #include <corda/corda.hpp>
///     #include <corda/testing.hpp>
///
///     EXPECT_THAT(film.frame(120), corda::testing::MatchesGolden("swing_0120.png"));
///
/// Needs gmock, which corda::corda does not link: link GTest::gmock_main, too. check_golden() describes the
/// environment variables.

#include <gmock/gmock.h>

#include <cerrno>
#include <cstdio>
#include <ostream>
#include <string>
#include <utility>

#include "corda/core/image.hpp"
#include "corda/golden/check_golden.hpp"

namespace corda {

/// Prints a picture for GoogleTest.
inline void PrintTo(const Image& image, std::ostream* out) {
    *out << "a picture of " << image.width() << "x" << image.height() << " pixels";
}

namespace testing {

/// The command that runs the present test alone; empty outside of tests.
inline std::string rerun_command() {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    if (test == nullptr) return "";
    return std::string(program_invocation_name) + " --gtest_filter=" + test->test_suite_name() + "." +
           test->name();
}

/// See MatchesGolden().
class GoldenMatcher {
  public:
    using is_gtest_matcher = void;

    GoldenMatcher(std::string name, GoldenOptions options)
        : name_(std::move(name)), options_(std::move(options)) {}

    bool MatchAndExplain(const Image& drawn, ::testing::MatchResultListener* listener) const {
        GoldenOptions options = options_;
        if (options.rerun.empty()) options.rerun = rerun_command();
        const GoldenOutcome outcome = check_golden(drawn, name_, options);
        if (outcome.written) std::fprintf(stderr, "%s\n", outcome.message.c_str());
        *listener << outcome.message;
        return outcome.matches;
    }
    void DescribeTo(std::ostream* out) const { *out << "matches the golden picture " << name_; }
    void DescribeNegationTo(std::ostream* out) const {
        *out << "does not match the golden picture " << name_;
    }

  private:
    std::string name_;
    GoldenOptions options_;
};

/// Matches a picture that equals the golden picture of this name, for example "swing_0120.png", or is within
/// the limits of `options`; see check_golden(). With `.film = &film` a failure names the keys that changed.
inline ::testing::Matcher<const Image&> MatchesGolden(std::string name, GoldenOptions options = {}) {
    return GoldenMatcher(std::move(name), std::move(options));
}

}  // namespace testing
}  // namespace corda
