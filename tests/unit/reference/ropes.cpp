#include "benchmark/study/reference/ropes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace corda::reference {
namespace {

TEST(ReferenceRopes, StraightOnesAreExactAtRightAngles) {
    for (const Vec2& point : straight_rope(7, 1.0, 90.0).points_m) EXPECT_EQ(point.y, 0.0);
    for (const Vec2& point : straight_rope(7, 1.0, 180.0).points_m) EXPECT_EQ(point.x, 0.0);
    const RopeDef rope = straight_rope(4, 2.0, 30.0);
    ASSERT_EQ(rope.points_m.size(), 5U);
    EXPECT_NEAR(rope.points_m.back().x, 1.0, 1e-15);
    EXPECT_NEAR(rope.points_m.back().y, -std::sqrt(3.0), 1e-15);
    EXPECT_NEAR(length_m(rope), 2.0, 1e-15);
}

TEST(ReferenceRopes, HaveTheLengthsOfTheirReferences) {
    EXPECT_NEAR(length_m(report_rope(40)), 39.0 * std::sqrt(1.01), 1e-13);
    EXPECT_NEAR(length_m(folded_rope(21)), 1.0, 1e-14);
    EXPECT_EQ(folded_rope(21).points_m.size(), 22U);
    EXPECT_EQ(folded_rope(21).points_m.back().y, 0.0);
    const RopeDef slack = slack_rope(20);
    EXPECT_NEAR(length_m(slack), 1.5, 1e-14);
    EXPECT_EQ(slack.points_m.back().x, 1.0);
    EXPECT_EQ(slack.pinned, (std::vector<std::uint32_t>{0, 20}));
}

TEST(ReferenceRopes, SpinningOneHasTheVelocityOfARotation) {
    const RopeDef rope = spinning_rope(10, 2.0, 3.0);
    EXPECT_EQ(rope.velocity_m_s.front(), (Vec2{0.0, 0.0}));
    EXPECT_EQ(rope.velocity_m_s.back(), (Vec2{0.0, 6.0}));
}

TEST(ReferenceRopes, ReleasedOnesHaveTheirTipMass) {
    const RopeDef rope = released_rope(kReleasedChains.back());
    EXPECT_EQ(rope.mass_kg.back(), 1000.0);
    EXPECT_EQ(rope.mass_kg.front(), 1.0);
    constexpr Vec2 kTip = released_tip_m(20, 45.0, 2.0);
    EXPECT_EQ(kTip.x, 0.53700529500088304879);
}

}  // namespace
}  // namespace corda::reference
