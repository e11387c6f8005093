#include "corda/sim/step_grid.hpp"

#include <gtest/gtest.h>

namespace corda::sim {
namespace {

TEST(StepGrid, FindsTimesOnTheGridDespiteTheirRounding) {
    for (const double step_s : {0.1, 1.0 / 3.0, 1.0 / 60.0, 1e-7}) {
        for (const std::uint64_t step : {0U, 1U, 2U, 7U, 1000U, 123456789U}) {
            const auto steps = static_cast<double>(step);
            for (const double time_s :
                 {step_s * steps, step_s * steps * (1.0 + 1e-15), steps / (1.0 / step_s)}) {
                const GridTime at = locate(time_s, step_s);
                EXPECT_TRUE(at.is_on_grid) << step_s << " " << step;
                EXPECT_EQ(at.step, step);
            }
        }
    }
}

TEST(StepGrid, TellsTimesBetweenTwoSteps) {
    const GridTime at = locate(0.523, 0.1);
    EXPECT_FALSE(at.is_on_grid);
    EXPECT_EQ(at.step, 5U);
    EXPECT_NEAR(at.fraction, 0.23, 1e-14);
    EXPECT_FALSE(locate(0.1 * (1.0 + 2e-9), 0.1).is_on_grid);
    EXPECT_TRUE(locate(0.1 * (1.0 + 0.5e-9), 0.1).is_on_grid);
    EXPECT_EQ(locate(0.1 * (1.0 - 2e-9), 0.1).step, 0U);
}

}  // namespace
}  // namespace corda::sim
