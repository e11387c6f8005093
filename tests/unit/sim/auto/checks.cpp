#include "corda/sim/auto/checks.hpp"

#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "corda/core/timeline.hpp"
#include "corda/reference/ropes.hpp"

namespace corda::sim {
namespace {

/// Of a rope that swings, in one thread (5 links) and in several (120).
class ChecksOfARope : public testing::TestWithParam<int> {
  protected:
    const RopeDef rope_ = reference::straight_rope(GetParam(), 1.0, 60.0);
    const System system_ = build_system({&rope_, 1});
    const GoesOn always_ = [] { return true; };
};

TEST_P(ChecksOfARope, AreWhereALooserRunIsNearly) {
    Checks checks(system_, WorldDef{}, ExactDef{1e-12}, 1.0 / 60.0, 3, always_);
    Simulation run(system_, WorldDef{}, ExactDef{1e-8});
    for (const double time_s : {0.1, 0.2, 0.3}) {
        checks.start(time_s);
        ASSERT_EQ(run.advance_to(time_s), Status::kOk);
        ASSERT_EQ(checks.finish(), Status::kOk);
        EXPECT_GT(checks.difference_m(run.state()), 1e-15);  // 3e-13 to 5e-11 m
        EXPECT_LT(checks.difference_m(run.state()), 1e-9);
    }
    EXPECT_GT(checks.steps(), run.diagnostics().steps);
}

TEST_P(ChecksOfARope, AskWhetherToGoOnInTheCallersThreadAlone) {
    const auto caller = std::this_thread::get_id();
    bool is_asked = false;
    const GoesOn never = [&] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        return !std::exchange(is_asked, true);
    };
    Checks checks(system_, WorldDef{}, ExactDef{1e-12}, 1.0 / 60.0, 3, never);
    is_asked = true;
    checks.start(30.0);  // a second of work or more
    try {
        static_cast<void>(checks.finish());
        ADD_FAILURE() << "nobody asked";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
}

TEST_P(ChecksOfARope, EndWithWhoeverStartedThem) {
    Checks checks(system_, WorldDef{}, ExactDef{1e-12}, 1.0 / 60.0, 3, always_);
    checks.start(1e6);
    EXPECT_EQ(checks.steps(), 0U);  // of the last finish(), whatever a thread has done since
}

INSTANTIATE_TEST_SUITE_P(Links, ChecksOfARope, testing::Values(5, 120));

}  // namespace
}  // namespace corda::sim
