#include "corda/sim/exact/string/part.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/cancel.hpp"
#include "corda/sim/exact/exact.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

using Reason = Refusal::Reason;

/// Why method exact cannot run a rope; std::nullopt if it can.
std::optional<Reason> refusal_of(const RopeDef& rope) {
    return test::refusal_of(build_system({&rope, 1}), ExactDef{1e-9});
}

TEST(ExactRefusesAString, ThatResistsBending) {
    RopeDef rope = reference::straight_rope(3, 1.0, 45.0);
    rope.material.is_string = true;
    EXPECT_EQ(refusal_of(rope), std::nullopt);
    rope.bending_n_m2 = 1.0;
    EXPECT_EQ(refusal_of(rope), Reason::kRigidBendingString);
}

TEST(ExactRefusesAString, ThatIsLongerThanItsRestLengthBetweenPins) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.5}}, {0.99, 2.0});
    EXPECT_EQ(refusal_of(rope), std::nullopt);
    rope.pinned = {0, 2};
    EXPECT_EQ(refusal_of(rope), Reason::kStretchedString);
}

TEST(ExactRefusesAString, ThatIsStraightBetweenTwoPins) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, {});
    rope.pinned = {0, 2};
    EXPECT_EQ(refusal_of(rope), Reason::kTautBetweenPins);
    rope.rest_m = {1.0, 1.001};
    EXPECT_EQ(refusal_of(rope), std::nullopt);
}

TEST(ExactRefusesAString, ThatIsClosed) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {});
    rope.closed = true;
    EXPECT_EQ(refusal_of(rope), Reason::kRigidStringGraph);
}

TEST(LongString, CanBeCancelledWhileItsFirstContactsAreFound) {
    RopeDef rope = reference::straight_rope(20'000, 3.0, 45.0);
    rope.material.is_string = true;
    const System system = build_system({&rope, 1});
    const CancelScope stop([] { return false; });
    try {
        static_cast<void>(Exact::make(system, WorldDef{}, ExactDef{1e-9}));
        FAIL() << "the string was made";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
}

TEST(LongString, StartsTautDespiteTheRoundingOfItsEnds) {
    constexpr int kLinks = 30'000;
    RopeDef rope = reference::straight_rope(kLinks, 3.0, 40.0);
    rope.material.is_string = true;
    rope.rest_m.assign(kLinks, 3.0 / kLinks);
    for (Vec2& point : rope.points_m) point = {0.8 * point.x - 0.6 * point.y, 0.6 * point.x + 0.8 * point.y};
    const System system = build_system({&rope, 1});
    std::uint64_t asked = 0;
    const CancelScope count([&asked] { return ++asked > 0; });
    const std::unique_ptr<Exact> exact = Exact::make(system, WorldDef{}, ExactDef{1e-9});
    EXPECT_LE(asked * kUpdatesPerCheck, 20U * kLinks);  // measured 8, of slack links 100
    std::vector<double> tension_n(kLinks);
    ASSERT_TRUE(exact->tensions(tension_n));
    for (const double tension : tension_n) EXPECT_GT(tension, 0.0);
}

TEST(SlackString, CarriesNoTensionAndFallsFreely) {
    RopeDef rope = test::string_of({{5.0, 1.0}, {5.1, 1.0}, {5.2, 1.0}}, {1.0, 1.0});
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(0.3));
    EXPECT_EQ(run.loads()->largest_tension_n, 0.0);
    EXPECT_EQ(run.loads()->pin_force_n, 0.0);
    EXPECT_EQ(run.state().x_m[0], 5.0);
    EXPECT_EQ(run.state().y_m[0], 1.0);
    for (const std::size_t i : {1U, 2U}) {
        EXPECT_NEAR(run.state().x_m[i], rope.points_m[i].x, 1e-15);
        EXPECT_NEAR(run.state().y_m[i], 1.0 - 0.5 * 9.81 * 0.09, 1e-14);
    }
    EXPECT_FALSE(run.solver().conserves_energy());
    EXPECT_NEAR(run.solver().energy_j(), 9.81 * 2.0, 1e-13);
    EXPECT_NEAR(run.solver().energy_scale_j(), 9.81 * 2.0 * 2.0, 1e-13);
}

TEST(SlackString, ComesToRestBetweenItsPins) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, {1.1, 1.1});
    rope.pinned = {0, 2};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(20.0));
    EXPECT_NEAR(run.state().y_m[1], -std::sqrt(1.1 * 1.1 - 1.0), 1e-12);
}

TEST(PinnedLinks, OfAStringStay) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.5, 0.0}, {1.0, 0.0}}, {1.0, 0.5});
    rope.pinned = {0, 1};
    test::ExactRun run(rope);
    ASSERT_TRUE(run.go(1.0));
    test::ExactRun pendulum(reference::straight_rope(1, 0.5, 90.0));
    ASSERT_TRUE(pendulum.go(1.0));
    EXPECT_NEAR(run.state().x_m[2], 0.5 + pendulum.state().x_m[1], 1e-12);
    EXPECT_NEAR(run.state().y_m[2], pendulum.state().y_m[1], 1e-12);
    rope.pinned = {0, 1, 2};
    test::ExactRun fixed(rope);
    ASSERT_TRUE(fixed.go(5.0));
    EXPECT_EQ(fixed.state().x_m, fixed.system().x_m);
}

}  // namespace
}  // namespace corda::sim
