// The peer XPBD (tests/benchmark/peers/xpbd.hpp) is the method that it claims to be: of first order, and a
// spring that stretches by Hooke's law.

#include "benchmark/peers/xpbd.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/ropes.hpp"
#include "support/gravity.hpp"
#include "support/slope.hpp"

namespace corda {
namespace {

using test::kGravity;

TEST(Xpbd, ConvergesToAReleasedChainWithFirstOrder) {
    const reference::ReleasedChain row{10, 1, 45, 1, 1, reference::released_tip_m(10, 45, 1)};
    const RopeDef rope = reference::released_rope(row);
    std::vector<std::pair<double, double>> errors_m;  ///< by step
    for (const int steps : {2000, 4000, 8000, 16000}) {
        peers::Xpbd run(build_system({&rope, 1}), {0.0, -kGravity});
        for (int k = 0; k < steps; ++k) run.step(row.time_s / steps);
        const Vec2 apart = run.position_m.back() - row.tip_m;
        errors_m.emplace_back(row.time_s / steps, std::hypot(apart.x, apart.y));
    }
    EXPECT_LT(errors_m.back().second, 1e-2);
    EXPECT_NEAR(test::slope(errors_m), 1.0, 0.2);
}

TEST(Xpbd, StretchesASpringAndLeavesASlackStringAlone) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.material.compliance_1_n = 1e-3;
    peers::Xpbd spring(build_system({&rope, 1}), {0.0, -kGravity});
    double lowest_m = 0.0;
    for (int k = 0; k < 100'000; ++k) {
        spring.step(1e-5);
        lowest_m = std::min(lowest_m, spring.position_m.back().y);
    }
    // Let go at its rest length, a mass of 1 kg sinks twice as far as it would stretch the spring at rest.
    EXPECT_NEAR(lowest_m, -1.0 - 2e-3 * kGravity, 1e-5);

    rope = reference::straight_rope(1, 1.0, 0.0);
    rope.points_m.back() = {0.0, -0.5};
    rope.rest_m = {1.0};
    rope.material.is_string = true;
    peers::Xpbd string(build_system({&rope, 1}), {0.0, -kGravity});
    for (int k = 0; k < 1000; ++k) string.step(1e-4);
    EXPECT_NEAR(string.position_m.back().y, -0.5 - 0.5 * kGravity * 0.01, 1e-3);
}

}  // namespace
}  // namespace corda
