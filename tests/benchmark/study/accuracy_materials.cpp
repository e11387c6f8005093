// What links are made of: R9 (section 4 of src/corda/sim/README.md), and a mass on a spring in closed form.

#include <algorithm>
#include <cmath>

#include "benchmark/study/accuracy.hpp"
#include "benchmark/study/problems.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/pendulum.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/defs.hpp"

namespace corda::study {
namespace {

/// The time at which a pendulum is at this x on its way down, before its first passage under the pin, in s.
double time_on_the_way_down_s(const reference::Pendulum& pendulum, double x_m) {
    double before_s = 0.0;
    double after_s = 0.25 * pendulum.period_s();
    for (int k = 0; k < 60; ++k) {
        const double middle_s = 0.5 * (before_s + after_s);
        (pendulum.direction(middle_s).x > x_m ? before_s : after_s) = middle_s;
    }
    return before_s;
}

/// A mass on a string of 1 m, let go at (0.6, 0), falls to y = -0.8, keeps the tangential part of its
/// velocity and moves on like the pendulum that turns at cos(angle) = 0.512.
void add_r9(std::vector<AccuracyCase>& cases) {
    constexpr double kSimulatedSeconds = 5.0;
    constexpr double kStartX = 0.6;
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {kStartX, 0.0}});
    rope.rest_m = {1.0};
    rope.material.is_string = true;
    const double fall_s = std::sqrt(2.0 * 0.8 / reference::kGravity);
    const reference::Pendulum pendulum(std::sqrt(static_cast<long double>(reference::kGravity)),
                                       std::acos(0.512L));
    const double lead_s = time_on_the_way_down_s(pendulum, kStartX);
    AccuracyCase& r9 =
        cases.emplace_back(AccuracyCase{"R9", "string that snaps taut", "fall, snap and swing, 5 s",
                                        "position / L", problem_of(rope, kSimulatedSeconds)});
    // Measured 1.3e-11 and 1.0e-14.
    r9.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-10}, {"exact, 1e-13", ExactDef{1e-13}, 1e-12}};
    r9.error_of = [=](Probe& probe) {
        double largest = 0.0;
        for (int k = 1; k <= 100; ++k) {
            const double time_s = kSimulatedSeconds * k / 100.0;
            probe.go(time_s);
            const Vec2 expected = time_s < fall_s
                                      ? Vec2{kStartX, -0.5 * reference::kGravity * time_s * time_s}
                                      : pendulum.direction(time_s - fall_s + lead_s);
            const Vec2 apart = probe.tip_m() - expected;
            largest = std::max(largest, sim::length(apart.x, apart.y));
        }
        return largest;
    };
}

/// y = -L - d (1 - cos(omega t)), d = m g / k, omega^2 = k / m, k = 1 / (compliance L).
void add_spring(std::vector<AccuracyCase>& cases) {
    constexpr double kSimulatedSeconds = 10.0;
    constexpr double kRestMetres = 0.7;
    constexpr double kMassKg = 2.0;
    constexpr double kCompliance = 0.01;  // 1/N
    RopeDef rope = reference::straight_rope(1, kRestMetres, 0.0);
    rope.mass_kg[1] = kMassKg;
    rope.material.compliance_1_n = kCompliance;
    const double stiffness_n_m = 1.0 / (kCompliance * kRestMetres);
    const double omega_1_s = std::sqrt(stiffness_n_m / kMassKg);
    AccuracyCase& spring = cases.emplace_back(AccuracyCase{"spring", "mass on a link that stretches",
                                                           "10 s from its rest length", "position / L",
                                                           problem_of(rope, kSimulatedSeconds)});
    // Measured 4.4e-11, 6.5e-15 and 4.7e-14.
    spring.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-9},
                      {"exact, 1e-13", ExactDef{1e-13}, 1e-13},
                      {"rattle, order 8", RattleDef{8, 0.01}, 1e-12}};
    spring.error_of = [=](Probe& probe) {
        double largest = 0.0;
        for (int k = 1; k <= 100; ++k) {
            const double time_s = kSimulatedSeconds * k / 100.0;
            probe.go(time_s);
            const double y_m = -kRestMetres - kMassKg * reference::kGravity / stiffness_n_m *
                                                  (1.0 - std::cos(omega_1_s * time_s));
            largest = std::max(largest, std::abs(probe.tip_m().y - y_m) / kRestMetres);
        }
        return largest;
    };
}

}  // namespace

void add_material_cases(std::vector<AccuracyCase>& cases) {
    add_r9(cases);
    add_spring(cases);
}

}  // namespace corda::study
