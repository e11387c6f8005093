// R1 to R3 and R10 (section 4 of src/corda/sim/README.md).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "benchmark/study/accuracy.hpp"
#include "benchmark/study/problems.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/pendulum.hpp"
#include "benchmark/study/reference/ropes.hpp"

namespace corda::study {
namespace {

void add_r1(std::vector<AccuracyCase>& cases) {
    AccuracyCase& r1 = cases.emplace_back(
        AccuracyCase{"R1", "IFToMM A01 pendulum, 2000 s", "2000 s", "position / L", a01_pendulum()});
    r1.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-6},            // measured 3.0e-8
                  {"exact, 1e-11", ExactDef{1e-11}, 1e-8},          // measured 2.9e-11
                  {"exact, 1e-13", ExactDef{1e-13}, 1e-9},          // measured 3.0e-11
                  {"rattle, order 8", RattleDef{8, 0.01}, 1e-10}};  // measured 2.7e-12
}

/// Adds the relative error of the time at which the tip passes under the pin with a known speed: its distance
/// from there at that time gives it.
void add_passage(const char* quantity, const std::string& title, const RopeDef& rope, double time_s,
                 double speed_m_s, const std::pair<double, double>& bounds,
                 std::vector<AccuracyCase>& cases) {
    AccuracyCase& passage = cases.emplace_back(
        AccuracyCase{"R2", "period at large angles", title, quantity, problem_of(rope, time_s)});
    passage.error_of = [time_s, speed_m_s](Probe& probe) {
        probe.go(time_s);
        return std::abs(probe.tip_m().x) / (speed_m_s * time_s);
    };
    passage.methods = {{"exact, 1e-13", ExactDef{1e-13}, bounds.first},
                       {"rattle, order 8", RattleDef{8, time_s / std::ceil(400.0 * time_s)}, bounds.second}};
}

void add_r2(std::vector<AccuracyCase>& cases) {
    for (const reference::SwingPeriod& row : reference::kSwingPeriods) {
        const double speed_m_s =
            std::sqrt(2.0 * reference::kGravity * (1.0 - std::cos(row.angle_deg * std::numbers::pi / 180.0)));
        // Near the top an error grows by exp(sqrt(g/L) t), and so does the rounding of the start itself.
        const bool is_near_top = row.angle_deg > 175;
        // Measured up to 170 deg: 3.5e-15 and 3.9e-16; above 5.0e-11 and 2.0e-10.
        const auto bounds = is_near_top ? std::pair{1e-9, 1e-9} : std::pair{1e-13, 1e-14};
        // The passage a whole period after the first, which is a quarter of a period after the start.
        add_passage(is_near_top ? "period, relative, near the top" : "period, relative",
                    fmt::format("{:g} deg", row.angle_deg), reference::straight_rope(1, 1.0, row.angle_deg),
                    1.25 * row.ratio * reference::kSmallSwingSeconds, speed_m_s, bounds, cases);
    }
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * reference::kGravity), 0.0};
    add_passage("period, relative", "circulating", rope, 3.0 * reference::kFullTurnSeconds,
                std::sqrt(6.0 * reference::kGravity), {1e-13, 1e-14}, cases);
}

/// When the tip gets to the vertical, in s.
double quarter_period_s(Probe& probe, double step_s) {
    double before_m = probe.tip_m().x;
    for (int k = 1;; ++k) {
        probe.go(k * step_s);
        const double x_m = probe.tip_m().x;
        if (x_m <= 0.0 || k * step_s > 1.0) return (k - x_m / (x_m - before_m)) * step_s;
        before_m = x_m;
    }
}

void add_r3(std::vector<AccuracyCase>& cases) {
    constexpr double kStepSeconds = 1.0 / 2000.0;
    for (const reference::RodPeriod& rod : reference::kRodPeriods) {
        RopeDef rope = reference::straight_rope(rod.links, 1.0, 90.0);
        rope.reach = 7;
        AccuracyCase& r3 = cases.emplace_back(AccuracyCase{
            "R3", "rigid rod", fmt::format("{} masses from the horizontal, step 1/2000 s", rod.links),
            "period, relative", problem_of(rope, 0.25 * rod.period_s)});
        r3.error_of = [rod](Probe& probe) {
            return std::abs(4.0 * quarter_period_s(probe, kStepSeconds) / rod.period_s - 1.0);
        };
        // Measured 1.73e-3.
        r3.methods = {{"relaxation, reach 7, 1000 sweeps", RelaxationDef{kStepSeconds, 1000}, 2e-3}};
        r3.is_slow = rod.links > 10;
    }
}

void add_r10(std::vector<AccuracyCase>& cases) {
    constexpr double kStepSeconds = 1.0 / 60.0;
    constexpr double kForceNewtons = -9.8;
    for (const double delta : {0.001, 0.01, 0.1}) {
        for (const double mass_kg : {0.1, 1.0, 10.0}) {
            // Two free particles that fall side by side: the bar between them never acts.
            RopeDef pair = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}});
            pair.pinned = {};
            pair.mass_kg.assign(2, mass_kg);
            RelaxationDef method{kStepSeconds};
            method.delta = delta;
            method.force_n = Vec2{0.0, kForceNewtons};
            AccuracyCase& r10 = cases.emplace_back(AccuracyCase{
                "R10", "damped free fall", fmt::format("delta {:g}, {:g} kg, 10 s", delta, mass_kg),
                "fall, relative", problem_of(pair, 10.0)});
            r10.error_of = [=](Probe& probe) {
                double largest = 0.0;
                for (int n = 1; n <= 600; ++n) {
                    probe.go(n * kStepSeconds);
                    const double fall_m =
                        reference::damped_fall_m(mass_kg, kStepSeconds, n, delta, kForceNewtons);
                    // The first step is an Euler step, which does not fall.
                    const double scale_m = n == 1 ? 1.0 : std::abs(fall_m);
                    largest = std::max(largest, std::abs(probe.tip_m().y - fall_m) / scale_m);
                }
                return largest;
            };
            r10.methods = {{"relaxation", method, 1e-12}};  // measured 2.4e-14
        }
    }
}

}  // namespace

void add_pendulum_cases(std::vector<AccuracyCase>& cases) {
    add_r1(cases);
    add_r2(cases);
    add_r3(cases);
    add_r10(cases);
}

}  // namespace corda::study
