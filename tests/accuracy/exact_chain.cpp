// Method `exact` with chains against R4 to R8 and R11 (section 4 of src/sim/README.md).

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "support/reference_files.hpp"
#include "support/root.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A chain of length 1 bent a little into the small oscillation of angular frequency `omega_1_s`, and the
/// shape of it.
struct Mode {
    RopeDef rope;
    std::vector<double> shape;
};

Mode make_mode(int links, double omega_1_s, double tip_mass_kg) {
    const auto count = static_cast<std::size_t>(links);
    const double a_m = 1.0 / links;
    std::vector<double> mass_kg(count + 1, 1.0);
    mass_kg.back() = tip_mass_kg;
    std::vector<double> tension_n(count + 2, 0.0);
    for (std::size_t i = count; i >= 1; --i) tension_n[i] = tension_n[i + 1] + 9.81 * mass_kg[i];
    // From the tip up, the direction in which the rows of (K - omega^2 M) x = 0 are stable.
    std::vector<double> x(count + 2, 0.0);
    x[count] = 1.0;
    double steepest = 0.0;
    for (std::size_t i = count; i >= 1; --i) {
        const double below = i < count ? x[i + 1] : 0.0;
        const double pull = tension_n[i] + tension_n[i + 1] - a_m * mass_kg[i] * omega_1_s * omega_1_s;
        x[i - 1] = (pull * x[i] - tension_n[i + 1] * below) / tension_n[i];
        steepest = std::max(steepest, std::abs(x[i] - x[i - 1]));
    }
    EXPECT_NEAR(x[0], 0.0, 1e-9 * *std::max_element(x.begin(), x.end()));
    x[0] = 0.0;
    Mode mode;
    mode.rope.points_m = {{0.0, 0.0}};
    for (std::size_t i = 1; i <= count; ++i) {
        const double dx_m = 1e-5 * a_m * (x[i] - x[i - 1]) / steepest;
        mode.rope.points_m.push_back(mode.rope.points_m.back() +
                                     Vec2{dx_m, -std::sqrt(a_m * a_m - dx_m * dx_m)});
    }
    mode.rope.velocity_m_s.assign(count + 1, {});
    mode.rope.mass_kg = mass_kg;
    for (std::size_t i = 0; i <= count; ++i) mode.shape.push_back(mass_kg[i] * x[i]);
    return mode;
}

/// Angular frequency from the 21st time at which the part of the mode in the shape is zero.
double measured_omega_1_s(const Mode& mode, double expected_1_s) {
    constexpr int kZero = 21;
    const auto part = [&](const State& state) {
        double sum = 0.0;
        for (std::size_t i = 0; i < mode.shape.size(); ++i) sum += mode.shape[i] * state.x_m[i];
        return sum;
    };
    const double half_period_s = std::numbers::pi / expected_1_s;
    test::ExactRun run(mode.rope, 1e-13);
    double last = part(run.state());
    int zeros = 0;
    int k = 0;
    for (; zeros < kZero && k < 20 * kZero; ++k) {
        EXPECT_TRUE(run.go((k + 1) * half_period_s / 8.0));
        const double next = part(run.state());
        if ((next < 0.0) != (last < 0.0)) ++zeros;
        last = next;
    }
    EXPECT_EQ(zeros, kZero);
    const auto part_at = [&](double time_s) {
        test::ExactRun again(mode.rope, 1e-13);
        EXPECT_TRUE(again.go(time_s));
        return part(again.state());
    };
    const double zero_s = test::root(part_at, (k - 1) * half_period_s / 8.0, k * half_period_s / 8.0);
    return (kZero - 0.5) * std::numbers::pi / zero_s;
}

TEST(SmallOscillationsR4, HaveTheFrequenciesOfTheLaguerreZeros) {
    for (const reference::SmallOscillation& row : reference::kSmallOscillations) {
        const Mode mode = make_mode(row.links, row.omega_1_s, row.tip_mass_kg);
        const double error = measured_omega_1_s(mode, row.omega_1_s) / row.omega_1_s - 1.0;
        std::printf("R4 N=%d tip %g omega %g: %.2e\n", row.links, row.tip_mass_kg, row.omega_1_s, error);
        EXPECT_LT(std::abs(error), 1e-6);  // measured 1.8e-8 (N = 50, largest), 2e-11 (lowest)
    }
}

TEST(ReleaseR5, EndsAtTheReference) {
    for (const reference::ReleasedChain& row : reference::kReleasedChains) {
        std::printf("R5 N=%d L=%g %g deg tip %g t=%g:", row.links, row.length_m, row.angle_deg,
                    row.tip_mass_kg, row.time_s);
        for (const double tolerance : {1e-9, 1e-12}) {
            test::ExactRun run(reference::released_rope(row), tolerance);
            ASSERT_TRUE(run.go(row.time_s));
            const double error_m = run.tip_error_m(row.tip_m);
            std::printf("  %.1e at %g", error_m, tolerance);
            EXPECT_LT(error_m, 1e-9);  // measured 2.9e-10 (tip 1000, 5 s), 3.1e-11 at 1e-12
        }
        std::printf("\n");
    }
}

/// Accelerations of all particles at the start, from the rates at which the links' directions change.
std::vector<Vec2> start_accelerations(ChainDynamics& dynamics) {
    const std::vector<double>& y = dynamics.initial_state();
    std::vector<double> slope(y.size());
    dynamics.derivative(y.data(), slope.data());
    const std::size_t links = dynamics.link_count();
    std::vector<Vec2> result = {{}};
    for (std::size_t i = 0; i < links; ++i) {
        const double rate = y[2 * links + i];
        const double turning = slope[2 * links + i];
        const Vec2 direction{y[i], y[links + i]};
        const Vec2 across{-direction.y, direction.x};
        const double length_m = 1.0 / static_cast<double>(links);
        result.push_back(result.back() + length_m * (turning * across - rate * rate * direction));
    }
    return result;
}

TEST(HorizontalRelease, FallsFreelyAtFirst) {
    for (const int links : {2, 10, 50}) {
        const RopeDef rope = reference::straight_rope(links, 1.0, 90.0);
        const System system = build_system({&rope, 1});
        ChainDynamics dynamics(system, system.bodies, WorldDef{});
        std::vector<double> tension_n;
        dynamics.tensions(dynamics.initial_state().data(), tension_n);
        for (const double tension : tension_n) EXPECT_LT(std::abs(tension), 1e-13);
        const std::vector<Vec2> accelerations = start_accelerations(dynamics);
        // The links but the first turn at no rate: every free particle has the first one's acceleration.
        for (std::size_t i = 1; i < accelerations.size(); ++i) {
            EXPECT_NEAR(accelerations[i].x, 0.0, 1e-13);
            EXPECT_NEAR(accelerations[i].y, -9.81, 1e-13);  // measured 1.8e-15; tensions and x exactly 0
        }
    }
}

TEST(FreeRope, FallsWithoutAnErrorOfTheStart) {
    RopeDef rope = reference::straight_rope(5, 1.0, 30.0);
    rope.pinned = {};
    test::ExactRun run(rope);
    for (const double time_s : {1.0 / 60.0, 0.1, 1.0, 3.0}) {
        ASSERT_TRUE(run.go(time_s));
        for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
            EXPECT_NEAR(run.state().x_m[i], rope.points_m[i].x, 1e-15);
            EXPECT_NEAR(run.state().y_m[i], rope.points_m[i].y - 0.5 * 9.81 * time_s * time_s, 3e-14);
        }
    }
}

TEST(HangingR6, BetweenTwoPinsComesToRestAsACatenary) {
    for (const reference::HangingChain& row : reference::kHangingChains) {
        test::ExactRun run(reference::slack_rope(row.links), 1e-12, WorldDef{{0.0, -9.81}, 40.0, 4.0});
        ASSERT_TRUE(run.go(40.0));
        // Each pin carries half of the weight and the horizontal tension.
        const double pull = run.loads().value().pin_force_n / 9.81;
        const double half_weight = 0.5 * (row.links - 1);
        const double horizontal = std::sqrt(pull * pull - half_weight * half_weight);
        const double lowest_m = *std::min_element(run.state().y_m.begin(), run.state().y_m.end());
        std::printf("R6 N=%d: tension %.1e lowest %.1e\n", row.links, horizontal - row.tension_over_weight,
                    lowest_m - row.lowest_m);
        EXPECT_NEAR(horizontal, row.tension_over_weight, 1e-10);  // measured 2e-13
        EXPECT_NEAR(lowest_m, row.lowest_m, 1e-10);               // measured 3e-16
    }
}

TEST(FoldedR7, FallsFasterThanFreely) {
    for (const reference::FoldedChain& row : reference::kFoldedChains) {
        const RopeDef rope = reference::folded_rope(row.links);
        for (std::size_t k = 0; k < 3; ++k) {
            const double fallen_m = 0.25 * static_cast<double>(k + 1);
            const auto above_m = [&](double time_s) {
                test::ExactRun run(rope, 1e-10);
                EXPECT_TRUE(run.go(time_s));
                return run.state().y_m.back() + fallen_m;
            };
            const double time_s = test::root(above_m, row.times_s[k] - 1e-4, row.times_s[k] + 1e-4);
            std::printf("R7 N=%d fallen %g: error %.1e s\n", row.links, fallen_m, time_s - row.times_s[k]);
            EXPECT_NEAR(time_s, row.times_s[k], 1e-6);  // measured 1.2e-7: digits of the reference
        }
    }
}

TEST(SpinningR8, StaysARigidRotation) {
    constexpr int kLinks = 10;
    constexpr double kRate = 3.0;
    const RopeDef rope = reference::spinning_rope(kLinks, 1.0, kRate);
    const WorldDef world{{0.0, 0.0}, 10.0, 0.0};
    test::ExactRun run(rope, 1e-10, world);
    double largest_m = 0.0;
    for (int k = 1; k <= 100; ++k) {
        ASSERT_TRUE(run.go(0.1 * k));
        for (std::size_t i = 0; i <= kLinks; ++i) {
            const double radius_m = rope.points_m[i].x;
            largest_m =
                std::max(largest_m, length(run.state().x_m[i] - radius_m * std::cos(kRate * 0.1 * k),
                                           run.state().y_m[i] - radius_m * std::sin(kRate * 0.1 * k)));
        }
    }
    std::printf("R8 after 10 s: %.1e m\n", largest_m);
    EXPECT_LT(largest_m, 1e-11);  // measured 1.3e-14

    ChainDynamics dynamics(run.system(), run.system().bodies, world);
    std::vector<double> tension_n;
    dynamics.tensions(dynamics.initial_state().data(), tension_n);
    for (int i = 1; i <= kLinks; ++i) {
        double outside = 0.0;
        for (int j = i; j <= kLinks; ++j) outside += j;
        EXPECT_NEAR(tension_n[static_cast<std::size_t>(i - 1)], kRate * kRate * outside / kLinks, 1e-12);
    }
}

TEST(ReportRopeR11, StaysOnTheReference) {
    test::ExactRun run(reference::report_rope(40), 1e-9, WorldDef{{0.0, -9.8}, 10.0, 0.0});
    for (const test::ReportFrame& frame : test::read_report_swing()) {
        ASSERT_TRUE(run.go(frame.time_s));
        double largest_m = 0.0;
        for (std::size_t i = 0; i < frame.points_m.size(); ++i) {
            largest_m = std::max(largest_m, length(run.state().x_m[i] - frame.points_m[i].x,
                                                   run.state().y_m[i] - frame.points_m[i].y));
        }
        std::printf("R11 t=%g: %.1e m\n", frame.time_s, largest_m);
        EXPECT_LT(largest_m, 1e-10);  // measured 6.0e-14 (of 39 m)
    }
}

TEST(ReportRopeR11, IsCloserThanTheToleranceAtEveryOrderOfTheSeries) {
    constexpr reference::PublishedTip kEnd = reference::kReportTips.back();
    static_assert(kEnd.time_s == 10.0);
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-13}) {
        test::ExactRun run(reference::report_rope(40), tolerance, WorldDef{{0.0, -9.8}, 10.0, 0.0});
        ASSERT_TRUE(run.go(10.0));
        const double error = run.tip_error_m(kEnd.tip_m) / 39.2;
        std::printf("R11 at %g: %.1e of the length\n", tolerance, error);
        EXPECT_LT(error, 1e-2 * tolerance);  // measured 1.4e-8, 1.3e-10, 4.0e-12, 2.2e-16
    }
}

}  // namespace
}  // namespace corda::sim
