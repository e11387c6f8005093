// The method `exact` with one link against PHYSICS R1 and R2: the mathematical pendulum.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "support/exact_run.hpp"

namespace corda::sim {
namespace {

/// x and y at t = 0.5, 1, ..., 2000. IFToMM benchmark A01 in more digits, see PHYSICS R1.
std::vector<double> read_a01() {
    std::ifstream file(std::filesystem::path(__FILE__).parent_path() / "data" / "a01_pendulum.txt");
    std::vector<double> numbers;
    for (double number = 0.0; file >> number;) numbers.push_back(number);
    return numbers;
}

double a01_error_m(double tolerance) {
    const std::vector<double> reference = read_a01();
    EXPECT_EQ(reference.size(), 8000U);
    test::ExactRun run(test::horizontal_rope(1, 1.0), tolerance);
    double largest = 0.0;
    for (std::size_t k = 0; k + 1 < reference.size(); k += 2) {
        EXPECT_TRUE(run.advance_to(0.25 * static_cast<double>(k + 2)));
        largest = std::max(largest, run.tip_error_m(reference[k], reference[k + 1]));
    }
    return largest;
}

TEST(PendulumR1, StaysOnTheReferenceFor2000Seconds) {
    EXPECT_LT(a01_error_m(1e-9), 1e-5);   // measured 1.0e-6
    EXPECT_LT(a01_error_m(1e-11), 1e-7);  // measured 6.5e-9
    EXPECT_LT(a01_error_m(1e-13), 1e-9);  // measured 2.0e-10
}

TEST(PendulumR1, LargestTensionIsThreeWeights) {
    test::ExactRun run(test::horizontal_rope(1, 1.0), 1e-12);
    ASSERT_TRUE(run.advance_to(2.3678419475762374 / 4.0));
    const Loads loads = run.solver.loads().value();
    EXPECT_NEAR(loads.largest_tension_n, 29.43, 1e-11);
    EXPECT_NEAR(loads.pin_force_n, 29.43, 1e-11);
}

/// The time at which x of the tip changes its sign for the last time before or after `near_s`.
double crossing_s(const RopeDef& rope, double near_s) {
    const auto x_m = [&](double time_s) {
        test::ExactRun run(rope, 1e-13);
        EXPECT_TRUE(run.advance_to(time_s));
        return run.state.x_m.back();
    };
    return test::root(x_m, near_s * (1.0 - 1e-3), near_s * (1.0 + 1e-3));
}

TEST(PeriodR2, AtLargeAnglesIsTheEllipticIntegral) {
    struct Row {
        double angle_deg;
        double ratio;  ///< T / T0
        double bound;
    };
    constexpr double kPeriod0Seconds = 2.006066680710647;
    // Near the top an error grows by exp(sqrt(g/L) t), and so does the rounding of the start itself.
    for (const Row& row : {Row{10, 1.0019071881432166, 1e-9}, Row{45, 1.0399733431968039, 1e-9},
                           Row{90, 1.1803405990160962, 1e-9}, Row{120, 1.3728805006183502, 1e-9},
                           Row{150, 1.762203729503756, 1e-9}, Row{170, 2.4393627196738841, 1e-9},
                           Row{179, 3.9010651603890857, 1e-7}, Row{179.9, 5.3668671090259463, 1e-7},
                           Row{179.99, 6.832737338014762, 1e-7}}) {
        // A quarter of a period after the start and a whole one after that.
        const double time_s =
            crossing_s(test::straight_rope(1, 1.0, row.angle_deg), 1.25 * row.ratio * kPeriod0Seconds);
        const double error = time_s / (1.25 * row.ratio * kPeriod0Seconds) - 1.0;
        std::printf("R2 %g deg: relative error of the period %.2e\n", row.angle_deg, error);
        // measured 1e-15 up to 170 deg, 1.3e-13 at 179, 9e-12 at 179.9, 4e-10 at 179.99
        EXPECT_LT(std::abs(error), row.bound) << row.angle_deg;
    }
}

TEST(PeriodR2, OfAFullTurnIsTheEllipticIntegral) {
    RopeDef rope = test::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * 9.81), 0.0};
    constexpr double kTurnSeconds = 1.0578477230355216;
    const double error = crossing_s(rope, 3.0 * kTurnSeconds) / (3.0 * kTurnSeconds) - 1.0;
    std::printf("R2 circulating: relative error of the period %.2e\n", error);
    EXPECT_LT(std::abs(error), 1e-9);  // measured 6e-16
}

}  // namespace
}  // namespace corda::sim
