// Method `rattle` on small oscillations of a hanging chain: R4 (src/sim/README.md).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
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

TEST(SmallOscillationsR4, OrderEightReturnsAfterThePeriod) {
    for (const reference::SmallOscillation& mode : modes()) {
        const double amplitude_m = 1e-7;
        const RopeDef rope = displaced(mode.links, mode.omega_1_s, amplitude_m);
        const std::size_t i = widest(rope);
        test::RattleRun run(rope, WorldDef{}, 8, 0.5 / largest_1_s(mode.links));
        // After a quarter period the position depends most on the frequency.
        ASSERT_TRUE(run.go(0.25 * 2.0 * std::numbers::pi / mode.omega_1_s));
        std::printf("N=%d omega=%g: quarter period off by %.1e of the amplitude\n", mode.links,
                    mode.omega_1_s, run.state().x_m[i] / amplitude_m);
        EXPECT_NEAR(run.state().x_m[i] / amplitude_m, 0.0, 1e-6) << mode.links << " " << mode.omega_1_s;
    }
}

TEST(SmallOscillationsR4, ATipMassSlowsTheFirstModeToTheReference) {
    // The mode of a chain with a payload by the same recurrence: m_k omega^2 u_k = T differences, from the
    // tip.
    for (const auto& [links, mass_kg, omega_1_s] : reference::kSmallOscillations) {
        if (mass_kg == 1.0) continue;
        const double link_m = 1.0 / links;
        RopeDef rope = reference::straight_rope(links, 1.0, 0.0);
        rope.mass_kg.back() = mass_kg;
        double u = 1.0;        // of the particle at hand
        double below_n = 0.0;  // tension over g below it
        double pull = 0.0;     // (tension / g) (u_below - u) / a
        for (auto i = static_cast<std::size_t>(links); i > 0; --i) {
            rope.points_m[i].x = 1e-7 * u;
            const double mass = rope.mass_kg[i];
            below_n += mass;
            pull -= mass * omega_1_s * omega_1_s * u / kGravity;
            u += pull * link_m / below_n;
        }
        test::RattleRun run(rope, WorldDef{}, 8, 1.0 / 4000.0);
        ASSERT_TRUE(run.go(0.25 * 2.0 * std::numbers::pi / omega_1_s));
        std::printf("tip mass %g: top %.1e, quarter period off by %.1e\n", mass_kg, u, run.tip_x() / 1e-7);
        EXPECT_NEAR(run.tip_x() / 1e-7, 0.0, 1e-6) << mass_kg;
    }
}

}  // namespace
}  // namespace corda::sim
