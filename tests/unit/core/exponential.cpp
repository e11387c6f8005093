#include "corda/core/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace corda {
namespace {

TEST(Exponential, AndLogarithmAreExactWhereTheyMustBe) {
    EXPECT_EQ(natural_log(1.0), 0.0);
    EXPECT_EQ(exponential(0.0), 1.0);
    EXPECT_EQ(natural_log(2.0), std::log(2.0));
}

TEST(Exponential, AndLogarithmAreThoseOfTheLibraryToRounding) {
    for (double x = 1e-9; x < 4e9; x *= 1.37) {
        const double log = natural_log(x);
        EXPECT_NEAR(log, std::log(x), 4e-16 * (1.0 + std::abs(log))) << x;  // measured: 1.9e-16
        EXPECT_NEAR(exponential(log) / std::exp(log), 1.0, 4e-16) << x;     // measured: 2.3e-16
    }
}

/// The bits of every machine.
TEST(Exponential, AndLogarithmHaveTheirBits) {
    EXPECT_EQ(natural_log(3.0), 0x1.193ea7aad030ap+0);
    EXPECT_EQ(natural_log(0.1), -0x1.26bb1bbb55515p+1);
    EXPECT_EQ(exponential(0.3), 0x1.599058c8c1a96p+0);
    EXPECT_EQ(exponential(-7.25), 0x1.7455fe323fafep-11);
}

}  // namespace
}  // namespace corda
