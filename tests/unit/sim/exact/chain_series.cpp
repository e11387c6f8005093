// Every kernel of a ChainSeries gives the same bits.

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

#include "corda/reference/ropes.hpp"
#include "corda/sim/exact/chain_series.hpp"

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

/// All that a kernel works out in three steps, as numbers in a row.
std::vector<double> trace(const RopeDef& rope, std::size_t order, SeriesKernel kernel) {
    const System system = build_system({&rope, 1});
    const ChainDynamics dynamics(system, system.bodies, WorldDef{{0.0, -9.81}, 1.0, 0.3});
    ChainSeries series(dynamics, dynamics.chains().front(), order, kernel);
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

TEST(SeriesKernels, GiveTheSameBits) {
    std::mt19937 random(7);
    int compared = 0;
    for (const SeriesKernel kernel : series_kernels()) {
        if (kernel == SeriesKernel::kBaseline) continue;
        for (const int links : {1, 2, 3, 4, 5, 7, 8, 9, 16, 31, 40}) {
            for (const int pins : {0, 1, 2}) {
                if (pins == 2 && links < 3) continue;
                const RopeDef rope = random_rope(random, links, pins);
                for (const std::size_t order : {4, 12, 16, 20}) {
                    const std::vector<double> expected = trace(rope, order, SeriesKernel::kBaseline);
                    EXPECT_TRUE(same_bits(trace(rope, order, kernel), expected))
                        << links << " links, " << pins << " pins, order " << order;
                    ++compared;
                }
            }
        }
    }
    if (series_kernels().size() == 1) GTEST_SKIP() << "this CPU has the baseline alone";
    EXPECT_GT(compared, 100);
}

}  // namespace
}  // namespace corda::sim
