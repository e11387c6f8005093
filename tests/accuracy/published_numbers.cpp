// The cases of section 4 of src/corda/sim/README.md: every method stays within its bound, and the estimates
// of auto are true. The cases, the bounds and the measured errors are in
// tests/benchmark/study/accuracy_*.cpp.

#include <gtest/gtest.h>

#include "benchmark/study/accuracy.hpp"

namespace corda::study {
namespace {

class PublishedNumbers : public testing::TestWithParam<AccuracyCase> {};

TEST_P(PublishedNumbers, AreMet) {
    constexpr Timing kNotTimed{0, 0.0};
    for (const AccuracyRow& row : run_accuracy_case(GetParam(), kNotTimed)) {
        EXPECT_EQ(row.failure, "") << row.title << ", " << row.method;
        EXPECT_LE(row.error, row.bound.value()) << row.title << ", " << row.method;
        std::printf("%s, %s: %.1e of %.1e\n", row.title.c_str(), row.method.c_str(), row.error, *row.bound);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, PublishedNumbers, testing::ValuesIn(accuracy_cases()), [](const auto& param) {
    return param.param.reference + "_" + std::to_string(param.index);
});

}  // namespace
}  // namespace corda::study
