#include "corda/sim/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace corda::sim {
namespace {

TEST(Spread, KnowsItsEndsAndWhatFewValuesExceed) {
    Spread spread;
    EXPECT_TRUE(spread.empty());
    for (int i = 0; i < 999; ++i) spread.add(1.0 + i * 0.001);
    spread.add(-500.0);
    spread.add(std::nan(""));
    EXPECT_EQ(spread.least(), -500.0);
    EXPECT_EQ(spread.largest(), 1.998);
    EXPECT_EQ(spread.size_exceeded_by(0.0), 500.0);
    // The 10 largest of 1000 sizes are 500 and those above 1.989.
    EXPECT_GE(spread.size_exceeded_by(0.01), 1.989);
    EXPECT_LE(spread.size_exceeded_by(0.01), 1.989 * 17.0 / 16.0);
}

TEST(Spread, OfTwoIsThatOfAllTheirValues) {
    Spread all;
    Spread a;
    Spread b;
    for (int i = 0; i < 100; ++i) {
        all.add(i * i);
        (i % 3 == 0 ? a : b).add(i * i);
    }
    a.add(b);
    a.add(Spread());
    EXPECT_EQ(a.least(), all.least());
    EXPECT_EQ(a.largest(), all.largest());
    for (const double share : {0.0, 0.1, 0.5})
        EXPECT_EQ(a.size_exceeded_by(share), all.size_exceeded_by(share));
}

}  // namespace
}  // namespace corda::sim
