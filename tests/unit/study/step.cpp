#include "corda/study/step.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace corda::study {
namespace {

TEST(Steps, AreHeardByTheInnermostListener) {
    take_step();
    int outer_steps = 0;
    int inner_steps = 0;
    const OnStep outer = [&] { ++outer_steps; };
    const OnStep inner = [&] { ++inner_steps; };
    const OnStep nobody;
    {
        const HearSteps hear_outer(outer);
        take_step();
        {
            const HearSteps hear_inner(inner);
            take_step();
            const HearSteps hear_nothing(nobody);
            take_step();
        }
        take_step();
    }
    take_step();
    EXPECT_EQ(outer_steps, 2);
    EXPECT_EQ(inner_steps, 1);
}

TEST(Steps, EndTheWorkByWhatTheListenerThrows) {
    const OnStep stop = [] { throw std::runtime_error("enough"); };
    {
        const HearSteps hear(stop);
        EXPECT_THROW(take_step(), std::runtime_error);
    }
    EXPECT_NO_THROW(take_step());
}

}  // namespace
}  // namespace corda::study
