#include "corda/core/stop_check.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace corda {
namespace {

TEST(StopCheck, CallsBackInProportionToTheWork) {
    int asked = 0;
    const GoesOn goes_on = [&asked] {
        ++asked;
        return true;
    };
    StopCheck stop(goes_on);
    stop.spend(StopCheck::kUpdates - 1);
    EXPECT_EQ(asked, 0);
    stop.spend(1);
    EXPECT_EQ(asked, 1);
    for (std::uint64_t i = 0; i < 10 * StopCheck::kUpdates; ++i) stop.spend(1);
    EXPECT_EQ(asked, 11);
    stop.spend(100 * StopCheck::kUpdates);
    EXPECT_EQ(asked, 12);
}

TEST(StopCheck, EndsTheWorkByAnErrorOrTheExceptionOfTheCallback) {
    const GoesOn no = [] { return false; };
    StopCheck refused(no);
    try {
        refused.spend(StopCheck::kUpdates);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
    const GoesOn fails = []() -> bool { throw std::runtime_error("enough"); };
    StopCheck failing(fails);
    EXPECT_THROW(failing.spend(StopCheck::kUpdates), std::runtime_error);
}

TEST(StopCheck, DoesNothingWithoutACallback) {
    const GoesOn empty;
    StopCheck of_empty(empty);
    StopCheck of_none;
    EXPECT_NO_THROW(of_empty.spend(StopCheck::kUpdates));
    EXPECT_NO_THROW(of_none.spend(StopCheck::kUpdates));
}

}  // namespace
}  // namespace corda
