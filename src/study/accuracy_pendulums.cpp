// R1 to R3 and R10 (section 4 of src/sim/README.md).

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "corda/reference/numbers.hpp"
#include "corda/reference/pendulum.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/study/accuracy.hpp"
#include "corda/study/problems.hpp"

namespace corda::study {
namespace {

void add_r1(bool is_quick, std::vector<AccuracyRow>& rows) {
    const Problem problem = a01_pendulum();
    const AccuracyRow named{"R1", "2000 s", "position / L"};
    const std::array<NamedMethod, 3> methods{{{"exact, 1e-9", ExactDef{1e-9}},
                                              {"exact, 1e-13", ExactDef{1e-13}},
                                              {"rattle, order 8", RattleDef{8, 1.0 / 100.0}}}};
    add_problem_rows(named, problem, methods, study_timing(is_quick), rows);
}

/// The relative error of the time at which the tip passes under the pin with a known speed: its distance from
/// there at that time gives it.
void add_passage(const AccuracyRow& named, const RopeDef& rope, double time_s, double speed_m_s,
                 std::vector<AccuracyRow>& rows) {
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-13", ExactDef{1e-13}},
         {"rattle, order 8", RattleDef{8, time_s / std::ceil(400.0 * time_s)}}}};
    const auto error_of = [&](Probe& probe) {
        probe.go(time_s);
        return std::abs(probe.tip_m().x) / (speed_m_s * time_s);
    };
    add_probe_rows(named, rope, WorldDef{}, methods, time_s, error_of, rows);
}

void add_r2(bool /*is_quick*/, std::vector<AccuracyRow>& rows) {
    for (const reference::SwingPeriod& row : reference::kSwingPeriods) {
        const double speed_m_s =
            std::sqrt(2.0 * reference::kGravity * (1.0 - std::cos(row.angle_deg * std::numbers::pi / 180.0)));
        const AccuracyRow named{"R2", fmt::format("{:g} deg", row.angle_deg),
                                row.angle_deg > 175 ? "period, relative, near the top" : "period, relative"};
        // The passage a whole period after the first, which is a quarter of a period after the start.
        add_passage(named, reference::straight_rope(1, 1.0, row.angle_deg),
                    1.25 * row.ratio * reference::kSmallSwingSeconds, speed_m_s, rows);
    }
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.velocity_m_s[1] = {std::sqrt(6.0 * reference::kGravity), 0.0};
    const AccuracyRow named{"R2", "circulating", "period, relative"};
    add_passage(named, rope, 3.0 * reference::kFullTurnSeconds, std::sqrt(6.0 * reference::kGravity), rows);
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

void add_r3(bool is_quick, std::vector<AccuracyRow>& rows) {
    constexpr double kStepSeconds = 1.0 / 2000.0;
    const std::array<NamedMethod, 1> methods{
        {{"relaxation, 7 n bars, 1000 sweeps", RelaxationDef{kStepSeconds, 1000}}}};
    for (const reference::RodPeriod& rod : reference::kRodPeriods) {
        if (is_quick && rod.links > 10) continue;
        const AccuracyRow named{"R3", fmt::format("{} masses from the horizontal, step 1/2000 s", rod.links),
                                "period, relative"};
        RopeDef rope = reference::straight_rope(rod.links, 1.0, 90.0);
        rope.reach = 7;
        const auto error_of = [&](Probe& probe) {
            return std::abs(4.0 * quarter_period_s(probe, kStepSeconds) / rod.period_s - 1.0);
        };
        add_probe_rows(named, rope, WorldDef{}, methods, 0.25 * rod.period_s, error_of, rows);
    }
}

void add_r10(bool /*is_quick*/, std::vector<AccuracyRow>& rows) {
    constexpr double kStepSeconds = 1.0 / 60.0;
    constexpr double kForceNewtons = -9.8;
    for (const double delta : {0.001, 0.01, 0.1}) {
        const AccuracyRow named{"R10", fmt::format("delta {:g}, 10 s", delta), "fall, relative"};
        RopeDef pair = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}});
        pair.pinned = {};
        RelaxationDef method{kStepSeconds};
        method.delta = delta;
        method.force_n = Vec2{0.0, kForceNewtons};
        const auto error_of = [&](Probe& probe) {
            double largest = 0.0;
            for (int n = 1; n <= 600; ++n) {
                probe.go(n * kStepSeconds);
                // The first step is an Euler step, which does not fall.
                if (n == 1) continue;
                const double fall_m = reference::damped_fall_m(1.0, kStepSeconds, n, delta, kForceNewtons);
                largest = std::max(largest, std::abs(probe.tip_m().y / fall_m - 1.0));
            }
            return largest;
        };
        const std::array<NamedMethod, 1> methods{{{"relaxation", method}}};
        add_probe_rows(named, pair, WorldDef{}, methods, 10.0, error_of, rows);
    }
}

}  // namespace

std::vector<AccuracyCase> pendulum_cases() {
    return {{"R1", "IFToMM A01 pendulum, 2000 s", add_r1},
            {"R2", "period at large angles", add_r2},
            {"R3", "rigid rod", add_r3},
            {"R10", "damped free fall", add_r10}};
}

}  // namespace corda::study
