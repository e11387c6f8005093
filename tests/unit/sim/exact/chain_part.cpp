#include "corda/sim/exact/chain_part.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/chains.hpp"
#include "support/unstopped.hpp"

namespace corda::sim {
namespace {

State start_of(const System& system) {
    return {0.0, system.x_m, system.y_m};
}

double largest_distance_m(const State& a, const State& b) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < a.x_m.size(); ++i)
        largest_m = std::max(largest_m, std::hypot(a.x_m[i] - b.x_m[i], a.y_m[i] - b.y_m[i]));
    return largest_m;
}

TEST(ChainPart, GivesTheSameBitsWhateverTimesAreAskedFor) {
    for (const test::Pins pins : {test::Pins::kNone, test::Pins::kStart, test::Pins::kBoth}) {
        const System system = test::chain(pins);
        ChainPart direct(system, system.bodies.front(), WorldDef{}, 1e-9);
        ChainPart often(system, system.bodies.front(), WorldDef{}, 1e-9);
        State state = start_of(system);
        State other = start_of(system);
        ASSERT_EQ(direct.advance_to(0.9, state, test::unstopped), Status::kOk);
        for (const double time_s : {0.0, 1e-6, 0.1, 0.1, 0.25, 0.8999999, 0.9})
            ASSERT_EQ(often.advance_to(time_s, other, test::unstopped), Status::kOk);
        EXPECT_EQ(state.x_m, other.x_m);
        EXPECT_EQ(state.y_m, other.y_m);
        EXPECT_EQ(direct.steps(), often.steps());
        EXPECT_EQ(direct.energy_j(), often.energy_j());
    }
}

TEST(ChainPart, ComesNearerToTheTruthByMoreSteps) {
    const System system = test::chain(test::Pins::kStart);
    const auto run = [&](double tolerance) {
        ChainPart part(system, system.bodies.front(), WorldDef{}, tolerance);
        State state = start_of(system);
        EXPECT_EQ(part.advance_to(0.5, state, test::unstopped), Status::kOk);
        EXPECT_EQ(part.rejected_steps(), 0U);
        return std::pair(state, part.steps());
    };
    const auto [truth, most_steps] = run(1e-15);
    const auto [fine, fine_steps] = run(1e-10);
    const auto [coarse, coarse_steps] = run(1e-5);
    EXPECT_LT(coarse_steps, fine_steps);
    EXPECT_LT(fine_steps, most_steps);
    EXPECT_LT(largest_distance_m(coarse, truth), 1e-5);
    EXPECT_LT(largest_distance_m(fine, truth), 1e-10);
}

TEST(ChainPart, LetsEachChainTakeStepsOfItsOwn) {
    // A long side and a side a hundred times as short, whose steps are about ten times as short.
    RopeDef rope = reference::rope_through({{-1.0, 0.0}, {0.0, 0.0}, {0.01, 0.0}});
    rope.pinned = {1};
    const System both = build_system({&rope, 1});
    RopeDef side = reference::rope_through({{0.0, 0.0}, {-1.0, 0.0}});
    const System alone = build_system({&side, 1});
    ChainPart two(both, both.bodies.front(), WorldDef{}, 1e-9);
    ChainPart one(alone, alone.bodies.front(), WorldDef{}, 1e-9);
    State state = start_of(both);
    State expected = start_of(alone);
    ASSERT_EQ(two.advance_to(2.0, state, test::unstopped), Status::kOk);
    ASSERT_EQ(one.advance_to(2.0, expected, test::unstopped), Status::kOk);
    EXPECT_EQ(state.x_m[0], expected.x_m[1]);
    EXPECT_EQ(state.y_m[0], expected.y_m[1]);
    EXPECT_GT(two.steps(), 5U * one.steps());
}

TEST(ChainPart, CannotReachATimeThatIsNone) {
    const System system = test::chain(test::Pins::kStart);
    ChainPart part(system, system.bodies.front(), WorldDef{}, 1e-9);
    State state = start_of(system);
    EXPECT_EQ(part.advance_to(std::numeric_limits<double>::infinity(), state, test::unstopped),
              Status::kDiverged);
    EXPECT_EQ(part.advance_to(std::numeric_limits<double>::quiet_NaN(), state, test::unstopped),
              Status::kDiverged);
    EXPECT_EQ(part.steps(), 0U);
}

}  // namespace
}  // namespace corda::sim
