// Every kernel of a ChainSeries gives the same bits.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/chain_series.hpp"
#include "unit/sim/exact/chains.hpp"

namespace corda::sim {
namespace {

/// A chain of unequal links and masses in motion, with a pin at its start, at both ends, or none.
RopeDef random_rope(std::mt19937& random, int links, int pins) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Vec2> points_m{{0.0, 0.0}};
    for (int i = 0; i < links; ++i)
        points_m.push_back(points_m.back() + Vec2{0.1 + unit(random), 2.0 * unit(random) - 1.0});
    RopeDef rope = reference::rope_through(std::move(points_m));
    for (double& mass_kg : rope.mass_kg) mass_kg = 0.1 + 10.0 * unit(random);
    for (Vec2& velocity_m_s : rope.velocity_m_s)
        velocity_m_s = {4.0 * unit(random) - 2.0, 4.0 * unit(random) - 2.0};
    if (pins == 0) rope.pinned = {};
    if (pins == 2) rope.pinned = {0, static_cast<std::uint32_t>(links)};
    return rope;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// A copy would work on the arrays of the original.
static_assert(!std::is_copy_constructible_v<ChainSeries> && !std::is_copy_assignable_v<ChainSeries>);

/// The results of three steps, one after the other.
std::vector<double> trace(const RopeDef& rope, std::size_t order, bool is_wide) {
    const System system = build_system({&rope, 1});
    const ChainDynamics dynamics(system, system.bodies, WorldDef{{0.0, -9.81}, 1.0, 0.3});
    ChainSeries series(dynamics.chains(), dynamics.chains().list.front(), order, is_wide);
    std::vector<double> state = dynamics.initial_state();
    std::vector<double> numbers;
    for (const double step_s : {0.01, 0.02, 0.3}) {  // the last turns links by more than is small
        series.expand(state.data(), step_s);
        numbers.push_back(series.longest_step_s(1e-9));
        series.evaluate(0.5 * step_s, state.data());
        numbers.insert(numbers.end(), state.begin(), state.end());
        series.evaluate(step_s, state.data());
        numbers.insert(numbers.end(), state.begin(), state.end());
    }
    return numbers;
}

TEST(WideSeries, HasTheSameBits) {
    if (!has_wide_series()) GTEST_SKIP() << "this CPU has no AVX2";
    std::mt19937 random(7);
    for (const int links : {1, 2, 3, 4, 5, 7, 8, 9, 16, 31, 40}) {
        for (const int pins : {0, 1, 2}) {
            if (pins == 2 && links < 3) continue;
            const RopeDef rope = random_rope(random, links, pins);
            for (const std::size_t order : {4, 12, 16, 20}) {
                EXPECT_TRUE(same_bits(trace(rope, order, true), trace(rope, order, false)))
                    << links << " links, " << pins << " pins, order " << order;
            }
        }
    }
}

State start_of(const System& system) {
    return {0.0, system.x_m, system.y_m};
}

double largest_distance_m(const State& a, const State& b) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < a.x_m.size(); ++i)
        largest_m = std::max(largest_m, std::hypot(a.x_m[i] - b.x_m[i], a.y_m[i] - b.y_m[i]));
    return largest_m;
}

TEST(ChainPart, GivesTheSameBitsForAnyRequestedTimes) {
    for (const test::Pins pins : {test::Pins::kNone, test::Pins::kStart, test::Pins::kBoth}) {
        const System system = test::chain(pins);
        ChainPart direct(system, WorldDef{}, 1e-9);
        ChainPart often(system, WorldDef{}, 1e-9);
        State state = start_of(system);
        State other = start_of(system);
        ASSERT_EQ(direct.advance_to(0.9, state), Status::kOk);
        for (const double time_s : {0.0, 1e-6, 0.1, 0.1, 0.25, 0.8999999, 0.9})
            ASSERT_EQ(often.advance_to(time_s, other), Status::kOk);
        EXPECT_EQ(state.x_m, other.x_m);
        EXPECT_EQ(state.y_m, other.y_m);
        EXPECT_EQ(direct.steps(), often.steps());
        EXPECT_EQ(direct.energy_j(), often.energy_j());
    }
}

TEST(ChainPart, IsMoreAccurateWithMoreSteps) {
    const System system = test::chain(test::Pins::kStart);
    const auto run = [&](double tolerance) {
        ChainPart part(system, WorldDef{}, tolerance);
        State state = start_of(system);
        EXPECT_EQ(part.advance_to(0.5, state), Status::kOk);
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
    ChainPart two(both, WorldDef{}, 1e-9);
    ChainPart one(alone, WorldDef{}, 1e-9);
    State state = start_of(both);
    State expected = start_of(alone);
    ASSERT_EQ(two.advance_to(2.0, state), Status::kOk);
    ASSERT_EQ(one.advance_to(2.0, expected), Status::kOk);
    EXPECT_EQ(state.x_m[0], expected.x_m[1]);
    EXPECT_EQ(state.y_m[0], expected.y_m[1]);
    EXPECT_GT(two.steps(), 5U * one.steps());
}

TEST(ChainPart, DivergesAtATimeThatIsNotFinite) {
    const System system = test::chain(test::Pins::kStart);
    ChainPart part(system, WorldDef{}, 1e-9);
    State state = start_of(system);
    EXPECT_EQ(part.advance_to(std::numeric_limits<double>::infinity(), state), Status::kDiverged);
    EXPECT_EQ(part.advance_to(std::numeric_limits<double>::quiet_NaN(), state), Status::kDiverged);
    EXPECT_EQ(part.steps(), 0U);
}

}  // namespace
}  // namespace corda::sim
