#include "corda/study/measure.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace corda::study {
namespace {

TEST(Steps, AreHeardByTheInnermostListener) {
    check_cancelled();
    int outer_steps = 0;
    int inner_steps = 0;
    const OnStep outer = [&] { ++outer_steps; };
    const OnStep inner = [&] { ++inner_steps; };
    const OnStep nobody;
    {
        const CancelScope hear_outer(outer);
        check_cancelled();
        {
            const CancelScope hear_inner(inner);
            check_cancelled();
            const CancelScope hear_nothing(nobody);
            check_cancelled();
        }
        check_cancelled();
    }
    check_cancelled();
    EXPECT_EQ(outer_steps, 2);
    EXPECT_EQ(inner_steps, 1);
}

TEST(Steps, EndTheWorkByWhatTheListenerThrows) {
    const OnStep stop = [] { throw std::runtime_error("enough"); };
    {
        const CancelScope hear(stop);
        EXPECT_THROW(check_cancelled(), std::runtime_error);
    }
    EXPECT_NO_THROW(check_cancelled());
}

}  // namespace
}  // namespace corda::study
