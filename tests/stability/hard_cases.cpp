// The hard cases of section 5 of src/corda/sim/README.md and tests of bits and denormal numbers. The cases,
// their bounds and measured values are in tests/benchmark/study/hard_*.cpp. CORDA_TEST_LONG=1 also runs the
// long ones.

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "benchmark/study/hard_cases.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "stability/denormal_trap.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

bool is_long() {
    return std::getenv("CORDA_TEST_LONG") != nullptr;
}

std::vector<study::HardCase> cases_to_test() {
    using Kind = study::HardCase::Kind;
    std::vector<study::HardCase> cases = study::hard_cases();
    std::erase_if(cases, [](const study::HardCase& hard) {
        return hard.kind == Kind::kNotTested || (hard.kind == Kind::kLong && !is_long());
    });
    return cases;
}

class HardCases : public testing::TestWithParam<study::HardCase> {};

TEST_P(HardCases, Pass) {
    const study::HardCase& hard = GetParam();
    const study::Outcome outcome = study::run_hard_case(hard);
    EXPECT_TRUE(outcome.passed) << hard.name << ", " << hard.method << ": " << outcome.measured
                                << "; expected " << hard.criterion;
    std::printf("%s, %s: %s\n", hard.name.c_str(), hard.method.c_str(), outcome.measured.c_str());
}

INSTANTIATE_TEST_SUITE_P(All, HardCases, testing::ValuesIn(cases_to_test()));

TEST(Bits, AreTheSameWhateverTimesAreAskedFor) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 80.0);
    test::ExactRun one(rope);
    ASSERT_TRUE(one.go(1.5));
    for (const int frames_per_second : {24, 30, 60, 120}) {
        test::ExactRun many(rope);
        for (int k = 0; k <= frames_per_second * 3 / 2; ++k) {
            ASSERT_TRUE(many.go(static_cast<double>(k) / frames_per_second));
        }
        EXPECT_EQ(one.state().x_m, many.state().x_m) << frames_per_second;
        EXPECT_EQ(one.state().y_m, many.state().y_m) << frames_per_second;
    }
}

TEST(Damped, StaysAtRestWithoutDenormalNumbers) {
    const double end_s = is_long() ? 1e5 : 1e4;
    test::ExactRun run(reference::straight_rope(5, 1.0, 45.0), 1e-7, WorldDef{{0.0, -9.81}, 1e5, 3.0});
    {
        const test::DenormalTrap trap;
        for (int k = 1; k <= 100; ++k) ASSERT_TRUE(run.go(0.01 * k * end_s));
    }
    EXPECT_NEAR(run.state().x_m.back(), 0.0, 1e-7);
    EXPECT_NEAR(run.state().y_m.back(), -1.0, 1e-12);
}

TEST(Impossible, AskedForTimesAndSpeedsEndInAStatus) {
    RopeDef rope = reference::straight_rope(3, 1.0, 0.0);
    rope.velocity_m_s.back() = {1e300, 0.0};
    test::ExactRun fast(rope);
    EXPECT_FALSE(fast.go(1.0));
    test::ExactRun endless(reference::straight_rope(3, 1.0, 10.0));
    EXPECT_FALSE(endless.go(std::numeric_limits<double>::infinity()));
}

TEST(PulledTaut, BetweenPinsItGoesOnOrSaysThatItDiverged) {
    // Thrown upwards so hard that the middle is pulled straight against both pins.
    RopeDef rope = reference::straight_rope(2, 1.0, 90.0);
    rope.points_m = {{0.0, 0.0}, {0.4, -0.3}, {0.8, 0.0}};
    rope.pinned = {0, 2};
    test::RattleRun run(rope, WorldDef{}, 4);
    EXPECT_TRUE(run.go(1.0));  // a triangle: it cannot move at all
    RopeDef longer = reference::straight_rope(10, 1.0, 90.0);
    for (std::size_t i = 0; i <= 10; ++i)
        longer.points_m[i] = {0.08 * static_cast<double>(i), i % 2 == 0 ? 0.0 : -0.06};
    longer.pinned = {0, 10};
    for (std::size_t i = 1; i < 10; ++i) longer.velocity_m_s[i] = {0.0, 5.0};
    test::RattleRun taut(longer, WorldDef{}, 4);
    if (taut.go(5.0, 300)) {
        EXPECT_LT(taut.strain(), 1e-9);
    }
}

}  // namespace
}  // namespace corda::sim
