#include "benchmark/study/hard_cases.hpp"

#include <gtest/gtest.h>

#include <set>

namespace corda::study {
namespace {

TEST(HardCases, AreDistinct) {
    std::set<std::string> names;
    for (const HardCase& hard : hard_cases()) {
        EXPECT_TRUE(names.insert(hard.name + ", " + hard.method).second) << hard.name << ", " << hard.method;
        EXPECT_FALSE(hard.criterion.empty());
    }
}

}  // namespace
}  // namespace corda::study
