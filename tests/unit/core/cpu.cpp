#include "corda/core/cpu.hpp"

#include <gtest/gtest.h>

#include <future>
#include <limits>
#include <thread>

namespace corda {
namespace {

/// Volatile, so that the CPU computes and not the compiler.
volatile double least_normal = std::numeric_limits<double>::min();

/// True if a result below the smallest normal number is 0.
bool flushes_results() {
    return least_normal / 2.0 == 0.0;
}
/// True if an operand below the smallest normal number counts as 0, in a product above it.
bool flushes_operands() {
    const volatile double denormal = std::numeric_limits<double>::denorm_min();
    return denormal * 0x1p+100 == 0.0;
}

TEST(FlushDenormals, TakesDenormalResultsAndOperandsAsZero) {
    const FlushDenormals flush;
    EXPECT_TRUE(flushes_results());
    EXPECT_TRUE(flushes_operands());
}

TEST(FlushDenormals, KeepsTheSmallestNormalNumber) {
    const FlushDenormals flush;
    EXPECT_GT(least_normal * 1.0, 0.0);
    EXPECT_EQ(least_normal * 1.0 * 0x1p+1022, 1.0);
}

TEST(FlushDenormals, EndsWithItsScopeAndMayBeNested) {
    {
        const FlushDenormals outer;
        { const FlushDenormals inner; }
        EXPECT_TRUE(flushes_results());
    }
    EXPECT_FALSE(flushes_results());
    EXPECT_FALSE(flushes_operands());
}

TEST(FlushDenormals, DoesNotAffectRunningThreads) {
    std::promise<void> flushing;
    bool other_flushes = true;
    std::thread other([&, flushes = flushing.get_future()]() mutable {
        flushes.wait();
        other_flushes = flushes_results();
    });
    {
        const FlushDenormals flush;
        flushing.set_value();
        other.join();
        EXPECT_TRUE(flushes_results());
    }
    EXPECT_FALSE(other_flushes);
}

}  // namespace
}  // namespace corda
