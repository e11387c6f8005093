#include "corda/study/hard_cases.hpp"

#include <gtest/gtest.h>

#include <set>

namespace corda::study {
namespace {

TEST(HardCases, RefuseBadScenes) {
    std::vector<HardCase> cases;
    add_hard_inputs(cases);
    EXPECT_EQ(cases.size(), 3U);
    for (const HardCase& hard : cases) {
        const Outcome outcome = hard.run();
        EXPECT_TRUE(outcome.passed) << hard.name << ": " << outcome.measured;
    }
}

TEST(HardCases, AreDistinct) {
    std::vector<HardCase> cases;
    add_hard_motions(cases);
    add_hard_sizes(cases);
    std::set<std::string> names;
    for (const HardCase& hard : cases) {
        EXPECT_TRUE(names.insert(hard.name + ", " + hard.method).second) << hard.name << ", " << hard.method;
        EXPECT_FALSE(hard.criterion.empty());
    }
}

}  // namespace
}  // namespace corda::study
