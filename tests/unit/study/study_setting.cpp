#include "corda/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace corda::study {
namespace {

using testing::HasSubstr;

TEST(Setting, NamesTheProcessor) {
    std::istringstream cpuinfo("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2.1 GHz\nflags: x\n");
    EXPECT_EQ(processor_name(cpuinfo), "Some CPU @ 2.1 GHz");
    std::istringstream other("processor : 0\n");
    EXPECT_EQ(processor_name(other), "unknown");
}

TEST(Setting, HasNoEmptyValues) {
    const auto pairs = setting({7, 0.04});
    ASSERT_EQ(pairs.size(), 6U);
    for (const auto& [name, value] : pairs) EXPECT_NE(value, "") << name;
    EXPECT_THAT(pairs[5].second, HasSubstr("7 repeats of at least 40 ms"));
    EXPECT_THAT(pairs[3].second, HasSubstr("-ffp-contract=off"));
}

}  // namespace
}  // namespace corda::study
