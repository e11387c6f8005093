#include "benchmark/study/reference/pendulum.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace corda::reference {

Pendulum::Pendulum(long double omega0_1_s, long double angle_rad)
    : omega0_1_s_(omega0_1_s), modulus_(std::sin(angle_rad / 2.0L)) {
    long double b = std::cos(angle_rad / 2.0L);
    mean_[0] = 1.0L;
    half_gap_[0] = modulus_;
    for (int n = 0; n < kMeans; ++n) {
        mean_[n + 1] = (mean_[n] + b) / 2.0L;
        half_gap_[n + 1] = (mean_[n] - b) / 2.0L;
        b = std::sqrt(mean_[n] * b);
    }
    period_s_ = 2.0L * std::numbers::pi_v<long double> / (mean_[kMeans] * omega0_1_s_);
}

Vec2 Pendulum::direction(long double time_s) const {
    const long double into_s = std::fmod(time_s, period_s_);
    // Amplitudes, descending from the last mean: sin(2 phi_{n-1} - phi_n) = c_n / a_n sin phi_n.
    long double phi = std::ldexp(mean_[kMeans] * omega0_1_s_ * into_s, kMeans);
    long double above = phi;
    for (int n = kMeans; n > 0; --n) {
        above = phi;
        phi = (phi + std::asin(half_gap_[n] / mean_[n] * std::sin(phi))) / 2.0L;
    }
    const long double half_sine = modulus_ * std::cos(above - phi);  // cn / dn = cos(phi_1 - phi_0)
    return {static_cast<double>(2.0L * half_sine * std::sqrt(1.0L - half_sine * half_sine)),
            static_cast<double>(2.0L * half_sine * half_sine - 1.0L)};
}

long double rod_omega0_1_s(int particles, double spacing_m, double gravity_m_s2) {
    long double first = 0.0L;
    long double second = 0.0L;
    for (int i = 1; i <= particles; ++i) {
        first += i;
        second += static_cast<long double>(i) * i;
    }
    return std::sqrt(gravity_m_s2 * first / (spacing_m * second));
}

long double rope_omega0_1_s(int links, double spacing_m, double gravity_m_s2) {
    // Newton's method from 0 stays below the least zero. L_N' = N (L_N - L_(N-1)) / x, and -N at 0.
    long double x = 0.0L;
    for (int i = 0; i < 100; ++i) {
        long double before = 1.0L;
        long double value = 1.0L - x;
        for (int n = 1; n < links; ++n)
            before = std::exchange(value, ((2 * n + 1 - x) * value - n * before) / (n + 1));
        const long double slope = x > 0.0L ? links * (value - before) / x : -links;
        const long double step = value / slope;
        x -= step;
        if (std::abs(step) <= 1e-18L * x) break;
    }
    return std::sqrt(gravity_m_s2 / spacing_m * x);
}

double damped_fall_m(double mass_kg, double step_s, int steps, double delta, double force_n) {
    const long double d = delta;
    const long double h = step_s;
    return static_cast<double>(h * h * force_n / (mass_kg * d) *
                               (steps - (1.0L - std::pow(1.0L - d, steps)) / d));
}

}  // namespace corda::reference
