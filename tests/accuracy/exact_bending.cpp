// The method `exact` with ropes that resist bending, against equations in angles integrated here, statics and
// the theory of slender bars (Euler and Bernoulli; Timoshenko, Vibration Problems in Engineering, ch. V).

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "accuracy/root.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "support/gravity.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using test::kGravity;

/// The classical Runge-Kutta method in equal steps.
template <std::size_t Count>
std::array<double, Count> integrate(
    const std::function<std::array<double, Count>(const std::array<double, Count>&)>& slope,
    std::array<double, Count> y, double time_s, int steps) {
    const double h = time_s / steps;
    const auto moved = [](std::array<double, Count> from, double by, const std::array<double, Count>& along) {
        for (std::size_t i = 0; i < Count; ++i) from[i] += by * along[i];
        return from;
    };
    for (int k = 0; k < steps; ++k) {
        const auto k1 = slope(y);
        const auto k2 = slope(moved(y, 0.5 * h, k1));
        const auto k3 = slope(moved(y, 0.5 * h, k2));
        const auto k4 = slope(moved(y, h, k3));
        for (std::size_t i = 0; i < Count; ++i) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    return y;
}

RopeDef rope_of(const std::vector<Vec2>& points_m, double bending_n_m2) {
    RopeDef rope = reference::rope_through(points_m);
    rope.bending_n_m2 = bending_n_m2;
    return rope;
}

/// Largest difference of a coordinate.
double distance_m(const State& state, const std::vector<double>& x_m, const std::vector<double>& y_m) {
    double largest = 0.0;
    for (std::size_t i = 0; i < x_m.size(); ++i) {
        largest = std::max({largest, std::abs(state.x_m[i] - x_m[i]), std::abs(state.y_m[i] - y_m[i])});
    }
    return largest;
}

/// Two links of 0.3 m and 0.5 m behind a link of 0.2 m along the x-axis that is clamped or, with `is_clamped`
/// false, not there.
void expect_lagrange(bool is_clamped) {
    constexpr double kA1 = 0.3;
    constexpr double kA2 = 0.5;
    constexpr double kM1 = 2.0;
    constexpr double kM2 = 0.7;
    constexpr double kBending = 3.0;
    constexpr double kStart1 = 0.4;
    constexpr double kStart2 = -0.9;
    const double clamp_n_m = is_clamped ? kBending / (0.5 * (0.2 + kA1)) : 0.0;
    const double corner_n_m = kBending / (0.5 * (kA1 + kA2));
    const auto slope = [&](const std::array<double, 4>& y) {
        const double apart = y[0] - y[1];
        const double c = std::cos(apart);
        const double s = std::sin(apart);
        const double m11 = (kM1 + kM2) * kA1 * kA1;
        const double m12 = kM2 * kA1 * kA2 * c;
        const double m22 = kM2 * kA2 * kA2;
        const double f1 = -kM2 * kA1 * kA2 * s * y[3] * y[3] - (kM1 + kM2) * kGravity * kA1 * std::cos(y[0]) -
                          clamp_n_m * std::sin(y[0]) - corner_n_m * s;
        const double f2 =
            kM2 * kA1 * kA2 * s * y[2] * y[2] - kM2 * kGravity * kA2 * std::cos(y[1]) + corner_n_m * s;
        const double determinant = m11 * m22 - m12 * m12;
        return std::array<double, 4>{y[2], y[3], (m22 * f1 - m12 * f2) / determinant,
                                     (m11 * f2 - m12 * f1) / determinant};
    };
    std::vector<Vec2> points_m{{-0.2, 0.0}, {0.0, 0.0}};
    if (!is_clamped) points_m.erase(points_m.begin());
    points_m.push_back({kA1 * std::cos(kStart1), kA1 * std::sin(kStart1)});
    points_m.push_back(points_m.back() + Vec2{kA2 * std::cos(kStart2), kA2 * std::sin(kStart2)});
    RopeDef rope = rope_of(points_m, kBending);
    rope.mass_kg[rope.mass_kg.size() - 2] = kM1;
    rope.mass_kg.back() = kM2;
    if (is_clamped) rope.pinned = {0, 1};
    for (const double time_s : {0.3, 1.0, 2.0}) {
        const auto y = integrate<4>(slope, {kStart1, kStart2, 0.0, 0.0}, time_s, 20000);
        test::ExactRun run(rope, 1e-12);
        ASSERT_TRUE(run.go(time_s));
        const double error_m = run.tip_error_m(
            {kA1 * std::cos(y[0]) + kA2 * std::cos(y[1]), kA1 * std::sin(y[0]) + kA2 * std::sin(y[1])});
        std::printf("two links, clamped %d, t=%g: %.1e m\n", is_clamped, time_s, error_m);
        EXPECT_LT(error_m, 1e-11);  // measured 1.5e-13
    }
}

TEST(TwoLinks, MoveAsLagrangesEquationsSay) {
    expect_lagrange(false);
}

TEST(TwoLinks, MoveAsLagrangesEquationsSayBehindAClamp) {
    expect_lagrange(true);
}

TEST(PinInTheMiddle, CouplesTheLinksOnBothSides) {
    constexpr double kLeft = 0.4;
    constexpr double kRight = 0.6;
    constexpr double kBending = 2.0;
    const double corner_n_m = kBending / (0.5 * (kLeft + kRight));
    // Angles of the directions from the pin; straight if they differ by pi.
    const auto slope = [&](const std::array<double, 4>& y) {
        const double torque_n_m = corner_n_m * std::sin(y[0] - y[1]);
        return std::array<double, 4>{y[2], y[3],
                                     (torque_n_m - kGravity * kLeft * std::cos(y[0])) / (kLeft * kLeft),
                                     (-torque_n_m - kGravity * kRight * std::cos(y[1])) / (kRight * kRight)};
    };
    const double left = std::numbers::pi - 0.3;
    const double right = 0.2;
    RopeDef rope = rope_of({{kLeft * std::cos(left), kLeft * std::sin(left)},
                            {0.0, 0.0},
                            {kRight * std::cos(right), kRight * std::sin(right)}},
                           kBending);
    rope.pinned = {1};
    test::ExactRun run(rope, 1e-12);
    for (const double time_s : {0.5, 2.0}) {
        const auto y = integrate<4>(slope, {left, right, 0.0, 0.0}, time_s, 20000);
        ASSERT_TRUE(run.go(time_s));
        const double error_m = distance_m(run.state(), {kLeft * std::cos(y[0]), 0.0, kRight * std::cos(y[1])},
                                          {kLeft * std::sin(y[0]), 0.0, kRight * std::sin(y[1])});
        std::printf("pin in the middle, t=%g: %.1e m, energy %.1e\n", time_s, error_m, run.energy_error());
        EXPECT_LT(error_m, 1e-12);             // measured 7e-15
        EXPECT_LT(run.energy_error(), 1e-13);  // measured 7e-16
    }
}

/// Angles in equilibrium of `links` links of length 1 in all behind a horizontal clamp, unit masses over
/// `links` each at their ends: the angle of the last one is shot for such that the clamp is met.
std::vector<double> cantilever_angles(int links, double bending_n_m2) {
    const double a_m = 1.0 / links;
    const double corner_n_m = bending_n_m2 / a_m;
    std::vector<double> angle(static_cast<std::size_t>(links) + 1, 0.0);
    // Torque on link i: corner (sin(towards the next) - sin(from the last)) - weight beyond times arm = 0.
    const auto clamp_angle = [&](double tip) {
        angle.back() = tip;
        double sine_after = 0.0;
        for (std::size_t i = angle.size() - 1; i >= 1; --i) {
            const double weight_n = kGravity / links * (static_cast<double>(angle.size() - i) - 0.5);
            const double sine_before = sine_after - weight_n * a_m * std::cos(angle[i]) / corner_n_m;
            angle[i - 1] = angle[i] - std::asin(sine_before);
            sine_after = sine_before;
        }
        return angle[0];
    };
    clamp_angle(test::root(clamp_angle, -0.7, 0.0));
    return angle;
}

RopeDef cantilever(const std::vector<double>& angle, double bending_n_m2) {
    const auto links = static_cast<double>(angle.size() - 1);
    std::vector<Vec2> points_m{{-1.0 / links, 0.0}, {0.0, 0.0}};
    for (std::size_t i = 1; i < angle.size(); ++i) {
        points_m.push_back(points_m.back() + Vec2{std::cos(angle[i]) / links, std::sin(angle[i]) / links});
    }
    RopeDef rope = rope_of(points_m, bending_n_m2);
    rope.pinned = {0, 1};
    rope.mass_kg.assign(points_m.size(), 1.0 / links);
    rope.mass_kg.back() = 0.5 / links;
    return rope;
}

TEST(Cantilever, StaysInEquilibrium) {
    constexpr double kBending = 5.0;  // the tip hangs down by 0.24 of the length
    const std::vector<double> angle = cantilever_angles(20, kBending);
    EXPECT_NEAR(angle[0], 0.0, 1e-14);
    test::ExactRun run(cantilever(angle, kBending));
    const State start = run.state();
    EXPECT_LT(start.y_m.back(), -0.2);
    double moment_n_m = 0.0;
    double weight_n = 0.0;
    for (std::size_t i = 2; i < start.x_m.size(); ++i) {
        moment_n_m += kGravity * run.system().mass_kg[i] * start.x_m[i];
        weight_n += kGravity * run.system().mass_kg[i];
    }
    for (const double time_s : {0.0, 0.5, 5.0}) {
        ASSERT_TRUE(run.go(time_s));
        const double moved_m = distance_m(run.state(), start.x_m, start.y_m);
        const double pin_force_n = run.loads().value().pin_force_n;
        std::printf("cantilever at t=%g: moved by %.1e m, force off by %.1e N\n", time_s, moved_m,
                    pin_force_n - (weight_n + 20.0 * moment_n_m));
        EXPECT_LT(moved_m, 1e-11);  // measured 1.7e-14
        // The clamped link of 1/20 m takes the moment by a couple at its pins; one bears the weight too.
        EXPECT_NEAR(pin_force_n, weight_n + 20.0 * moment_n_m, 1e-9);  // measured 1e-11
    }
}

TEST(Cantilever, ComesToRestThereWithDrag) {
    constexpr double kBending = 5.0;
    const std::vector<double> angle = cantilever_angles(8, kBending);
    const RopeDef at_rest = cantilever(angle, kBending);
    test::ExactRun run(cantilever(std::vector<double>(angle.size(), 0.0), kBending), 1e-9,
                       WorldDef{{0.0, -kGravity}, 10.0, 4.0});
    ASSERT_TRUE(run.go(16.0));
    std::vector<double> x_m;
    std::vector<double> y_m;
    for (const Vec2& point : at_rest.points_m) {
        x_m.push_back(point.x);
        y_m.push_back(point.y);
    }
    const double apart_m = distance_m(run.state(), x_m, y_m);
    std::printf("cantilever with drag: %.1e m from rest\n", apart_m);
    EXPECT_LT(apart_m, 1e-11);  // measured 2.4e-15
}

TEST(Cantilever, HangsDownByTheBarsDeflectionInTheLimit) {
    constexpr double kBending = 1e5;
    std::vector<double> error;
    for (const int links : {10, 20, 40}) {
        const std::vector<double> angle = cantilever_angles(links, kBending);
        test::ExactRun run(cantilever(angle, kBending));
        ASSERT_TRUE(run.go(0.02));
        // w L^4 / (8 E I). Between the middles of two links the direction turns as the bar's does: the clamp
        // is the middle of the link that never moves, half a link before the pin.
        const double bar_m = 1.0 + 0.5 / links;
        const double limit_m = kGravity * bar_m * bar_m * bar_m * bar_m / (8.0 * kBending);
        error.push_back(-run.state().y_m.back() / limit_m - 1.0);
        std::printf("cantilever N=%d: deflection off by %.2e\n", links, error.back());
    }
    EXPECT_NEAR(error[0] / error[1], 4.0, 0.4);  // measured 3.81
    EXPECT_NEAR(error[1] / error[2], 4.0, 0.2);  // measured 3.90
    EXPECT_LT(std::abs(error[2]), 1e-3);         // measured 3.1e-4
}

/// Angular frequency of the first bending of a free bar of length, mass and E I of 1, from the time at which
/// the projection on the continuous bar's shape is zero for the third time.
double free_bar_omega_1_s(int links) {
    const double a_m = 1.0 / links;
    constexpr double kBeta = 4.730040745;  // cos x cosh x = 1
    const double ratio = (std::cosh(kBeta) - std::cos(kBeta)) / (std::sinh(kBeta) - std::sin(kBeta));
    std::vector<Vec2> points_m;
    std::vector<double> shape;
    for (int i = 0; i <= links; ++i) {
        const double z = kBeta * i * a_m;
        shape.push_back(std::cosh(z) + std::cos(z) - ratio * (std::sinh(z) + std::sin(z)));
    }
    points_m.push_back({0.0, 1e-6 * shape[0]});
    for (std::size_t i = 1; i < shape.size(); ++i) {
        const double rise_m = 1e-6 * (shape[i] - shape[i - 1]);
        points_m.push_back(points_m.back() + Vec2{std::sqrt(a_m * a_m - rise_m * rise_m), rise_m});
    }
    RopeDef rope = rope_of(points_m, 1.0);
    rope.pinned = {};
    rope.mass_kg.assign(points_m.size(), a_m);
    rope.mass_kg.front() = rope.mass_kg.back() = 0.5 * a_m;
    const auto part_at = [&](double time_s) {
        test::ExactRun run(rope, 1e-12, WorldDef{{0.0, 0.0}, 10.0, 0.0});
        EXPECT_TRUE(run.go(time_s));
        double part = 0.0;
        for (std::size_t i = 0; i < shape.size(); ++i)
            part += rope.mass_kg[i] * shape[i] * run.state().y_m[i];
        return part;
    };
    const double expected_s = 2.5 * std::numbers::pi / (kBeta * kBeta);
    return 2.5 * std::numbers::pi / test::root(part_at, 0.9 * expected_s, 1.1 * expected_s);
}

TEST(FreeBar, VibratesAtItsFrequencyInTheLimit) {
    const double omega_1_s = 4.730040745 * 4.730040745;
    std::vector<double> error;
    for (const int links : {8, 16, 32}) {
        error.push_back(free_bar_omega_1_s(links) / omega_1_s - 1.0);
        std::printf("free bar N=%d: frequency off by %.3e\n", links, error.back());
    }
    EXPECT_NEAR(error[0] / error[1], 4.0, 0.3);                         // measured 3.79
    EXPECT_NEAR(error[1] / error[2], 4.0, 0.1);                         // measured 3.94
    EXPECT_LT(std::abs(error[2] + (error[2] - error[1]) / 3.0), 1e-4);  // measured 7.6e-5
}

RopeDef bent_rope(int links) {
    std::vector<Vec2> points_m{{0.0, 0.0}};
    for (int i = 0; i < links; ++i) {
        const double angle = 0.7 * std::sin(0.9 * i) - 0.3;
        const double length_m = (i % 3 == 0 ? 0.5 : 1.2) / links;
        points_m.push_back(points_m.back() + Vec2{length_m * std::cos(angle), length_m * std::sin(angle)});
    }
    RopeDef rope = rope_of(points_m, 0.02);
    for (std::size_t i = 0; i < rope.mass_kg.size(); ++i) rope.mass_kg[i] = i % 2 ? 0.1 : 0.05;
    return rope;
}

TEST(Energy, IsKept) {
    const std::vector<std::vector<std::uint32_t>> pins{{},  {0},    {0, 1},           {0, 12},
                                                       {5}, {4, 5}, {0, 1, 7, 11, 12}};
    for (const std::vector<std::uint32_t>& pinned : pins) {
        RopeDef rope = bent_rope(12);
        rope.pinned = pinned;
        rope.velocity_m_s[6] = {1.0, 2.0};
        test::ExactRun run(rope);
        ASSERT_TRUE(run.go(2.0, 120));
        EXPECT_LT(run.strain(), 1e-13);
        std::printf("bending with %zu pins: energy %.1e\n", pinned.size(), run.energy_error());
        EXPECT_LT(run.energy_error(), 1e-9);  // measured 1.8e-12
    }
}

TEST(Mirrored, MovesTheSame) {
    RopeDef rope = bent_rope(12);
    rope.pinned = {0, 1, 5};
    RopeDef reversed = rope;
    std::reverse(reversed.points_m.begin(), reversed.points_m.end());
    std::reverse(reversed.mass_kg.begin(), reversed.mass_kg.end());
    reversed.pinned = {7, 11, 12};
    RopeDef mirrored = rope;
    for (Vec2& point : mirrored.points_m) point.x = -point.x;
    test::ExactRun run(rope);
    test::ExactRun reversed_run(reversed);
    test::ExactRun mirrored_run(mirrored);
    ASSERT_TRUE(run.go(0.5) && reversed_run.go(0.5) && mirrored_run.go(0.5));
    for (std::size_t i = 0; i <= 12; ++i) {
        EXPECT_EQ(run.state().x_m[i], -mirrored_run.state().x_m[i]);
        EXPECT_EQ(run.state().y_m[i], mirrored_run.state().y_m[i]);
    }
    State back = reversed_run.state();
    std::reverse(back.x_m.begin(), back.x_m.end());
    std::reverse(back.y_m.begin(), back.y_m.end());
    const double apart_m = distance_m(run.state(), back.x_m, back.y_m);
    std::printf("reversed: %.1e m apart\n", apart_m);
    EXPECT_LT(apart_m, 1e-12);  // measured 3.1e-15
}

TEST(Bending, ThatIsNegligibleChangesNoMotion) {
    // Two integrators: with bends it is Dop853, without a Taylor series.
    RopeDef rope = bent_rope(12);
    rope.bending_n_m2 = 0.0;
    test::ExactRun without(rope);
    rope.bending_n_m2 = 1e-300;
    test::ExactRun with(rope);
    ASSERT_TRUE(without.go(1.0) && with.go(1.0));
    const double apart_m = distance_m(without.state(), with.state().x_m, with.state().y_m);
    std::printf("next to no bending: %.1e m apart\n", apart_m);
    EXPECT_LT(apart_m, 1e-9);  // measured 3.8e-11
}

}  // namespace
}  // namespace corda::sim
