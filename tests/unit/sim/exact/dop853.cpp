#include "corda/sim/exact/dop853.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "support/slope.hpp"

namespace corda::sim {
namespace {

/// x' = -y + x (1 - r^2), y' = x + y (1 - r^2): turns by 1 rad/s and spirals to r = 1,
/// r(t) = 1 / sqrt(1 + (1 / r(0)^2 - 1) exp(-2 t)).
class Spiral final : public Ode {
  public:
    static constexpr double kStartRadius = 0.3;
    void derivative(const double* y, double* slope) override {
        const double gain = 1.0 - (y[0] * y[0] + y[1] * y[1]);
        slope[0] = gain * y[0] - y[1];
        slope[1] = gain * y[1] + y[0];
    }
    static std::vector<double> at(double time_s) {
        const double radius =
            1.0 / std::sqrt(1.0 + (1.0 / (kStartRadius * kStartRadius) - 1.0) * std::exp(-2.0 * time_s));
        return {radius * std::cos(time_s), radius * std::sin(time_s)};
    }
};

double error_of(const std::vector<double>& y, double time_s) {
    const std::vector<double> expected = Spiral::at(time_s);
    return std::max(std::abs(y[0] - expected[0]), std::abs(y[1] - expected[1]));
}

/// Steps of a fixed size: any error is accepted.
StepControl fixed_step(double step_s) {
    return {std::numeric_limits<double>::max(), step_s, step_s, 0.0};
}

TEST(Dop853, HasOrderEight) {
    std::vector<std::pair<double, double>> errors;  // over the step
    for (const int steps : {6, 8, 10, 12, 16}) {
        Spiral spiral;
        Dop853 integrator(spiral, Spiral::at(0.0), {{0, 2}}, fixed_step(3.0 / steps));
        for (int k = 0; k < steps; ++k) ASSERT_EQ(integrator.step(), Status::kOk);
        std::vector<double> end(2);
        integrator.interpolate(integrator.time_s(), end.data());
        errors.emplace_back(3.0 / steps, error_of(end, integrator.time_s()));
    }
    const double slope = test::slope(errors);
    std::printf("order %.2f, errors %.1e .. %.1e\n", slope, errors.front().second, errors.back().second);
    EXPECT_NEAR(slope, 8.0, 0.3);  // measured 7.81
}

TEST(Dop853, InterpolatesWithOrderSeven) {
    // Within one step from the same start the error of order p is of size h^(p + 1).
    std::vector<std::pair<double, double>> errors;  // over the step
    for (const double step_s : {0.5, 0.4, 0.3, 0.2}) {
        Spiral spiral;
        Dop853 integrator(spiral, Spiral::at(0.0), {{0, 2}}, fixed_step(step_s));
        ASSERT_EQ(integrator.step(), Status::kOk);
        double largest = 0.0;
        for (int k = 1; k < 20; ++k) {
            std::vector<double> y(2);
            const double time_s = step_s * k / 20.0;
            integrator.interpolate(time_s, y.data());
            largest = std::max(largest, error_of(y, time_s));
        }
        errors.emplace_back(step_s, largest);
    }
    const double slope = test::slope(errors);
    std::printf("interpolation: slope %.2f, errors %.1e .. %.1e\n", slope, errors.front().second,
                errors.back().second);
    EXPECT_NEAR(slope, 8.0, 0.3);  // measured 8.05
}

TEST(Dop853, InterpolatesTheEndsOfAStepExactly) {
    Spiral spiral;
    Dop853 integrator(spiral, Spiral::at(0.0), {{0, 2}}, fixed_step(0.25));
    ASSERT_EQ(integrator.step(), Status::kOk);
    std::vector<double> first_end(2);
    std::vector<double> second_start(2);
    integrator.interpolate(0.25, first_end.data());
    ASSERT_EQ(integrator.step(), Status::kOk);
    integrator.interpolate(0.25, second_start.data());
    EXPECT_EQ(first_end, second_start);
}

TEST(Dop853, KeepsItsErrorsNearTheTolerance) {
    double last = std::numeric_limits<double>::infinity();
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
        Spiral spiral;
        StepControl control{tolerance, 1e-3, 10.0, 1e-12};
        Dop853 integrator(spiral, Spiral::at(0.0), {{0, 2}}, control);
        ASSERT_EQ(integrator.advance_to(10.0), Status::kOk);
        std::vector<double> y(2);
        integrator.interpolate(10.0, y.data());
        const double error = error_of(y, 10.0);
        std::printf("tolerance %.0e: error %.1e in %llu + %llu steps\n", tolerance, error,
                    static_cast<unsigned long long>(integrator.accepted_steps()),
                    static_cast<unsigned long long>(integrator.rejected_steps()));
        EXPECT_LT(error, 10.0 * tolerance);
        EXPECT_LT(error, last);
        last = error;
    }
}

TEST(Dop853, AcceptsStepsWhoseErrorsUnderflow) {
    for (const double start : {1e-140, 1e-155, 1e-165, 1e-300, 0.0}) {
        Spiral spiral;
        Dop853 integrator(spiral, {start, 0.0}, {{0, 2}}, StepControl{1e-9, 1e-3, 1.0, 1e-12});
        EXPECT_EQ(integrator.advance_to(10.0), Status::kOk) << start;
        EXPECT_EQ(integrator.rejected_steps(), 0U) << start;
    }
}

/// y' = y^2 from 1: infinite at t = 1.
class BlowUp final : public Ode {
  public:
    void derivative(const double* y, double* slope) override { slope[0] = y[0] * y[0]; }
};

TEST(Dop853, DivergesIfTheSolutionEnds) {
    BlowUp ode;
    Dop853 integrator(ode, {1.0}, {{0, 1, 1.0, 1.0}}, StepControl{1e-9, 1e-3, 1.0, 1e-9});
    EXPECT_EQ(integrator.advance_to(1.1), Status::kDiverged);
    EXPECT_LT(integrator.time_s(), 1.0 + 1e-6);
    EXPECT_GT(integrator.time_s(), 1.0 - 1e-6);
    EXPECT_GT(integrator.rejected_steps(), 0U);
    EXPECT_EQ(integrator.advance_to(std::numeric_limits<double>::infinity()), Status::kDiverged);
}

/// A thousand constant components and two that turn quickly.
class OneAmongMany final : public Ode {
  public:
    static constexpr std::size_t kSize = 1002;
    void derivative(const double* y, double* slope) override {
        std::fill_n(slope, kSize, 0.0);
        slope[700] = -50.0 * y[701];
        slope[701] = 50.0 * y[700];
    }
};

TEST(Dop853, NoticesOneComponentAmongThousands) {
    OneAmongMany ode;
    std::vector<double> start(OneAmongMany::kSize, 0.0);
    start[700] = 1.0;
    Dop853 integrator(ode, start, {{0, OneAmongMany::kSize}}, StepControl{1e-9, 1e-3, 10.0, 1e-12});
    ASSERT_EQ(integrator.advance_to(1.0), Status::kOk);
    std::vector<double> y(OneAmongMany::kSize);
    integrator.interpolate(1.0, y.data());
    std::printf("one among many: off by %.1e\n", y[700] - std::cos(50.0));
    EXPECT_NEAR(y[700], std::cos(50.0), 1e-7);  // measured 1.2e-9
    EXPECT_NEAR(y[701], std::sin(50.0), 1e-7);
}

/// A point on a circle, brought back onto it after each step.
class Circle final : public Ode {
  public:
    void derivative(const double* y, double* slope) override {
        slope[0] = -y[1];
        slope[1] = y[0];
    }
    void project(double* y) override {
        const double radius = std::sqrt(y[0] * y[0] + y[1] * y[1]);
        y[0] /= radius;
        y[1] /= radius;
    }
};

TEST(Dop853, GoesOnFromTheProjectedState) {
    Circle circle;
    Dop853 integrator(circle, {1.0, 0.0}, {{0, 2}}, fixed_step(1.0));
    for (int k = 0; k < 10; ++k) {
        ASSERT_EQ(integrator.step(), Status::kOk);
        std::vector<double> y(2);
        integrator.interpolate(integrator.time_s(), y.data());
        EXPECT_NEAR(y[0] * y[0] + y[1] * y[1], 1.0, 4e-16);
    }
}

}  // namespace
}  // namespace corda::sim
