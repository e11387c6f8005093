// Method `rattle` on small oscillations of a hanging chain: R4 (src/corda/sim/README.md).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "support/gravity.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using test::kGravity;

/// A hanging chain of 1 m, displaced by at most `amplitude_m` in the mode of frequency omega: the Laguerre
/// polynomials L_k(x), k counted from the tip, x = omega^2 a / g.
RopeDef displaced(int links, double omega_1_s, double amplitude_m) {
    const double a = 1.0 / links;
    const double x = omega_1_s * omega_1_s * a / kGravity;
    std::vector<double> shape{1.0, 1.0 - x};
    for (int k = 1; k < links; ++k)
        shape.push_back(((2 * k + 1 - x) * shape[static_cast<std::size_t>(k)] -
                         k * shape[static_cast<std::size_t>(k - 1)]) /
                        (k + 1));
    double largest = 0.0;
    for (int k = 0; k < links; ++k) largest = std::max(largest, std::abs(shape[static_cast<std::size_t>(k)]));
    for (double& u : shape) u /= largest;
    RopeDef rope = reference::straight_rope(links, 1.0, 0.0);
    for (int i = 1; i <= links; ++i)
        rope.points_m[static_cast<std::size_t>(i)] = {
            amplitude_m * shape[static_cast<std::size_t>(links - i)], -i * a};
    return rope;
}

/// The particle that is displaced most.
std::size_t widest(const RopeDef& rope) {
    std::size_t widest = 0;
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
        if (std::abs(rope.points_m[i].x) > std::abs(rope.points_m[widest].x)) widest = i;
    }
    return widest;
}

/// The rows of R4 whose masses are all the same.
std::vector<reference::SmallOscillation> modes() {
    std::vector<reference::SmallOscillation> equal;
    std::copy_if(reference::kSmallOscillations.begin(), reference::kSmallOscillations.end(),
                 std::back_inserter(equal), [](const auto& mode) { return mode.tip_mass_kg == 1.0; });
    return equal;
}

/// At least the largest frequency of a chain: R4's, which has that of every number of links but 5.
double largest_1_s(int links) {
    double largest = links == 5 ? 35.0 : 0.0;
    for (const reference::SmallOscillation& mode : modes()) {
        if (mode.links == links) largest = std::max(largest, mode.omega_1_s);
    }
    return largest;
}

TEST(SmallOscillationsR4, OrderTwoShiftsEveryFrequencyByVerletsSine) {
    for (const reference::SmallOscillation& mode : modes()) {
        const double h = 0.3 / largest_1_s(mode.links);  // what the guard leaves whole
        const RopeDef rope = displaced(mode.links, mode.omega_1_s, 1e-7);
        const std::size_t i = widest(rope);
        test::RattleRun run(rope, WorldDef{}, 2, h);
        // x(n+1) + x(n-1) = 2 cos(omega_num h) x(n), summed over a quarter of a period.
        const int steps = std::max(4, static_cast<int>(0.2 * 2.0 * std::numbers::pi / (mode.omega_1_s * h)));
        double before_m = run.state().x_m[i];
        ASSERT_TRUE(run.go(h));
        double here_m = run.state().x_m[i];
        double curvature = 0.0;
        double sum = 0.0;
        for (int n = 2; n <= steps; ++n) {
            ASSERT_TRUE(run.go(n * h));
            const double after_m = run.state().x_m[i];
            curvature += (here_m - before_m) - (after_m - here_m);
            sum += here_m;
            before_m = here_m;
            here_m = after_m;
        }
        const double half_sine = 0.5 * std::sqrt(curvature / sum);  // sin(omega_num h / 2)
        const double error = half_sine / (0.5 * mode.omega_1_s * h) - 1.0;
        std::printf("N=%d omega=%g: sine shift off by %.1e, parts %g\n", mode.links, mode.omega_1_s, error,
                    static_cast<double>(run.solver().parts()) / static_cast<double>(run.solver().steps()));
        EXPECT_EQ(run.solver().parts(), run.solver().steps());
        // measured: 1.3e-8 (N = 50, largest) and less
        EXPECT_NEAR(error, 0.0, 1e-6) << mode.links << " " << mode.omega_1_s;
    }
}

}  // namespace
}  // namespace corda::sim
