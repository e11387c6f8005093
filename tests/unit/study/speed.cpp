#include "corda/study/speed.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace corda::study {
namespace {

TEST(Speed, TakesTheCheapestRunThatMeetsTheError) {
    std::vector<Measurement> runs(4);
    runs[0].rms_error = 1e-2;
    runs[0].ms_per_simulated_s.add(1.0);
    runs[1].rms_error = 1e-5;
    for (const double ms : {1.0, 5.0, 5.1}) runs[1].ms_per_simulated_s.add(ms);
    runs[2].rms_error = 1e-7;
    runs[2].ms_per_simulated_s.add(3.0);
    runs[3].failure = "diverged";  // its error of 0 does not count
    EXPECT_EQ(cheapest_within(runs, 1e-1), &runs[0]);
    EXPECT_EQ(cheapest_within(runs, 1e-4), &runs[2]);
    EXPECT_EQ(cheapest_within(runs, 1e-9), nullptr);
    runs[1].rms_error = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cheapest_within(runs, 1e-5), &runs[2]);
}

TEST(Times, HaveAMiddleAndEnds) {
    report::Times times;
    EXPECT_EQ(times.median(), 0.0);
    for (const double time : {3.0, 1.0, 10.0}) times.add(time);
    EXPECT_EQ(times.median(), 3.0);
    times.add(2.0);
    EXPECT_EQ(times.median(), 2.5);
    EXPECT_EQ(times.least(), 1.0);
    EXPECT_EQ(times.times(10.0).largest(), 100.0);
}

}  // namespace
}  // namespace corda::study
