// Method `rattle` on swinging chains against the tip positions of R5 (src/sim/README.md), which have more
// digits than a double holds.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "support/reference_files.hpp"
#include "support/slope.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

TEST(SwingingChainsR5, HaveTheTipsOfTheReference) {
    // Measured with order 8: 0 to 4e-14, the last row 1.3e-10.
    for (const reference::ReleasedChain& row : reference::kReleasedChains) {
        const bool is_heavy = row.tip_mass_kg > 1.0;
        const bool is_wild = row.links == 10 && row.angle_deg == 90 && row.time_s == 2 && !is_heavy;
        const double bound_m = is_wild ? 1e-7 : 1e-9;
        // The last row magnifies errors by a million: 1.4e-7 with h = 1/1000.
        test::RattleRun run(reference::released_rope(row), WorldDef{}, 8,
                            is_heavy ? 1.0 / 8000.0 : 1.0 / 2000.0);
        ASSERT_TRUE(run.go(row.time_s));
        const double error_m = run.tip_error_m(row.tip_m);
        std::printf("N=%d L=%g angle=%g tip=%g t=%g: error %.1e, parts/steps %g\n", row.links, row.length_m,
                    row.angle_deg, row.tip_mass_kg, row.time_s, error_m,
                    static_cast<double>(run.solver().parts()) / static_cast<double>(run.solver().steps()));
        EXPECT_LT(error_m, bound_m) << row.links << " links, " << row.angle_deg
                                    << " degrees, t = " << row.time_s;
    }
}

TEST(RattleOnR11, StaysOnTheReference) {
    test::RattleRun run(reference::report_rope(40), WorldDef{{0.0, -9.8}, 10.0, 0.0}, 8, 1.0 / 600.0);
    double largest_m = 0.0;
    for (const test::ReportFrame& frame : test::read_report_swing()) {
        ASSERT_TRUE(run.go(frame.time_s));
        for (std::size_t i = 0; i < frame.points_m.size(); ++i) {
            largest_m = std::max(largest_m, std::hypot(run.state().x_m[i] - frame.points_m[i].x,
                                                       run.state().y_m[i] - frame.points_m[i].y));
        }
    }
    EXPECT_LT(largest_m, 1e-12);  // measured 6.5e-14, of 39 m
}

/// The tip's error after 1 s, N = 20.
double error_m(int order, double steps_per_second, double angle_deg = 45.0) {
    test::RattleRun run(reference::straight_rope(20, 1.0, angle_deg), WorldDef{}, order,
                        1.0 / steps_per_second);
    EXPECT_TRUE(run.go(1.0));
    // A step that is divided would show a slope of its own.
    EXPECT_EQ(run.solver().parts(), run.solver().steps()) << order << " " << steps_per_second;
    const Vec2 tip_m = angle_deg == 90.0 ? reference::released_tip_m(20, 90.0, 1.0)
                                         : reference::released_tip_m(20, 45.0, 1.0);
    return run.tip_error_m(tip_m);
}

/// The order that the errors show.
double slope(int order, const std::vector<double>& steps_per_second, double angle_deg = 45.0) {
    std::vector<std::pair<double, double>> errors_m;  // over the step
    for (const double rate : steps_per_second)
        errors_m.emplace_back(1.0 / rate, error_m(order, rate, angle_deg));
    return test::slope(errors_m);
}

TEST(Order, IsTheSlopeOfTheError) {
    const double two = slope(2, {500, 1000, 2000, 4000});
    const double four = slope(4, {320, 500, 800, 1200, 2000});
    const double six = slope(6, {320, 400, 500, 640});
    // From 45 degrees, order 8 is at rounding (1e-14) with every step that the guard leaves whole.
    const double eight = slope(8, {450, 500, 550, 600, 700}, 90.0);
    std::printf("slopes: %.3f %.3f %.3f %.3f\n", two, four, six, eight);
    // measured: 2.002, 4.005, 5.997, 8.01
    EXPECT_NEAR(two, 2.0, 0.15);
    EXPECT_NEAR(four, 4.0, 0.15);
    EXPECT_NEAR(six, 6.0, 0.15);
    EXPECT_NEAR(eight, 8.0, 0.15);
}

TEST(Order, FourReachesWhatThePrototypeReached) {
    // Section 2 of src/sim/README.md: 1.9e-9 at 1000 steps and 7.6e-12 at 4000 over all particles.
    EXPECT_LT(error_m(4, 1000), 1e-10);  // measured 5.2e-11 at the tip
    EXPECT_LT(error_m(4, 4000), 1e-12);  // measured 2.2e-13
}

}  // namespace
}  // namespace corda::sim
