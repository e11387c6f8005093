// R4 to R8 and R11 (section 4 of src/corda/sim/README.md).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "benchmark/study/accuracy.hpp"
#include "benchmark/study/problems.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"

namespace corda::study {
namespace {

constexpr double kAmplitude = 1e-7;  ///< of a mode, in m; small, because lengths change by its square

/// A small oscillation of a hanging chain of 1 m, and the particle that it moves most.
struct Mode {
    RopeDef rope;
    std::size_t widest = 0;
};

/// Solves (K - omega^2 M) u = 0 row by row from the tip up, the direction in which that is stable.
Mode mode_of(int links, double omega_1_s, double tip_mass_kg) {
    const auto count = static_cast<std::size_t>(links);
    const double link_m = 1.0 / links;
    Mode mode;
    mode.rope = reference::straight_rope(links, 1.0, 0.0);
    mode.rope.mass_kg.back() = tip_mass_kg;
    std::vector<double> shape(count + 1);
    double u = 1.0;
    double carried_kg = 0.0;
    double pull = 0.0;  // (tension / g) (u of the particle below - u) / link
    for (std::size_t i = count; i > 0; --i) {
        const double mass_kg = mode.rope.mass_kg[i];
        shape[i] = u;
        carried_kg += mass_kg;
        pull -= mass_kg * omega_1_s * omega_1_s * u / reference::kGravity;
        u += pull * link_m / carried_kg;
        if (std::abs(shape[i]) > std::abs(shape[mode.widest])) mode.widest = i;
    }
    for (std::size_t i = 1; i <= count; ++i)
        mode.rope.points_m[i] = {kAmplitude * shape[i] / shape[mode.widest],
                                 -link_m * static_cast<double>(i)};
    return mode;
}

void add_r4(std::vector<AccuracyCase>& cases) {
    for (const reference::SmallOscillation& row : reference::kSmallOscillations) {
        const Mode mode = mode_of(row.links, row.omega_1_s, row.tip_mass_kg);
        // After a quarter of its period a mode passes zero.
        const double time_s = 0.5 * std::numbers::pi / row.omega_1_s;
        AccuracyCase& r4 =
            cases.emplace_back(AccuracyCase{"R4", "small oscillations",
                                            fmt::format("N = {}, tip mass {:g} kg, omega {:.6g} / s",
                                                        row.links, row.tip_mass_kg, row.omega_1_s),
                                            "frequency, relative", problem_of(mode.rope, time_s)});
        r4.error_of = [widest = mode.widest, time_s](Probe& probe) {
            probe.go(time_s);
            return std::abs(probe.state().x_m[widest]) / kAmplitude / (0.5 * std::numbers::pi);
        };
        // Measured 1.7e-8 for N = 50 at its largest frequency.
        r4.methods = {{"exact, 1e-13", ExactDef{1e-13}, 1e-7},
                      {"rattle, order 8", RattleDef{8, 1.0 / 4000.0}, 1e-7}};
    }
}

void add_r5(std::vector<AccuracyCase>& cases) {
    for (const reference::ReleasedChain& row : reference::kReleasedChains) {
        const bool is_heavy = row.tip_mass_kg > 1.0;
        std::string title = fmt::format("N = {}, {:g} deg, {:g} s", row.links, row.angle_deg, row.time_s);
        if (is_heavy) title += fmt::format(", tip mass {:g} kg", row.tip_mass_kg);
        AccuracyCase& r5 = cases.emplace_back(AccuracyCase{"R5", "released chains", std::move(title),
                                                           is_heavy ? "tip / L, heavy tip" : "tip / L",
                                                           released_problem(row)});
        // Measured: 1.4e-10, 3.8e-14 and 5.7e-14; with a heavy tip 2.2e-10, 1.6e-11 and 2.9e-10.
        r5.methods = {{"exact, 1e-9", ExactDef{1e-9}, 5e-10},
                      {"exact, 1e-13", ExactDef{1e-13}, is_heavy ? 1e-10 : 1e-12},
                      {"rattle, order 8", RattleDef{8, is_heavy ? 1.0 / 7680.0 : 1.0 / 1920.0},
                       is_heavy ? 1e-9 : 1e-12}};
    }
}

void add_r6(std::vector<AccuracyCase>& cases) {
    constexpr double kDragSettles = 8.0;
    constexpr double kSettledSeconds = 20.0;
    for (const reference::HangingChain& row : reference::kHangingChains) {
        AccuracyCase& r6 = cases.emplace_back(
            AccuracyCase{"R6", "hanging between two pins", fmt::format("N = {}", row.links),
                         "tension, relative; lowest point / span",
                         problem_of(reference::slack_rope(row.links), kSettledSeconds)});
        r6.problem.world.drag_1_s = kDragSettles;
        r6.error_of = [row](Probe& probe) {
            probe.go(kSettledSeconds);
            // Each pin carries half of the weight and the horizontal tension.
            const double pull = probe.figures().loads.value_or(Loads{}).pin_force_n / reference::kGravity;
            const double half_weight = 0.5 * (row.links - 1);
            const double tension = std::sqrt(std::max(0.0, pull * pull - half_weight * half_weight));
            const auto& y_m = probe.state().y_m;
            const double lowest_m = *std::ranges::min_element(y_m);
            return std::max(std::abs(tension / row.tension_over_weight - 1.0),
                            std::abs(lowest_m - row.lowest_m));
        };
        // Measured 1.1e-13 and 8.7e-14.
        r6.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-12}, {"rattle, order 4", RattleDef{4}, 1e-12}};
    }
}

void add_r7(std::vector<AccuracyCase>& cases) {
    for (const reference::FoldedChain& row : reference::kFoldedChains) {
        AccuracyCase& r7 = cases.emplace_back(
            AccuracyCase{"R7", "falling folded chain, 7 digits", fmt::format("{} links", row.links),
                         "times of the fall, relative",
                         problem_of(reference::folded_rope(row.links), row.times_s.back())});
        r7.error_of = [row](Probe& probe) {
            constexpr double kNear = 1e-4;  // s; gives the speed of the tip around the time
            double largest = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double time_s = row.times_s[k];
                probe.go(time_s - kNear);
                const double before_m = probe.tip_m().y;
                probe.go(time_s);
                const double there_m = probe.tip_m().y + 0.25 * static_cast<double>(k + 1);
                probe.go(time_s + kNear);
                const double speed_m_s = (probe.tip_m().y - before_m) / (2.0 * kNear);
                largest = std::max(largest, std::abs(there_m / speed_m_s) / time_s);
            }
            return largest;
        };
        // Measured 3.3e-7: the digits of the reference.
        r7.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-6},
                      {"rattle, order 8", RattleDef{8, 1.0 / 4000.0}, 1e-6}};
    }
}

void add_r8(std::vector<AccuracyCase>& cases) {
    for (const double omega_1_s : {3.0, 7.0}) {
        AccuracyCase r8{"R8", "spinning chain", fmt::format("N = 10, {:g} / s, 10 s", omega_1_s),
                        "position / L", spinning_chain(omega_1_s)};
        // Measured 9.3e-13 and 1.2e-14.
        r8.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-11}, {"rattle, order 8", RattleDef{8}, 1e-12}};
        cases.push_back(r8);
        r8.quantity = "largest tension, relative";
        r8.error_of = [omega_1_s](Probe& probe) {
            const double tension_n = omega_1_s * omega_1_s * 0.1 * 55.0;  // m omega^2 a (1 + ... + 10)
            probe.go_by_frames(10.0);
            const double largest_n = probe.diagnostics().largest.loads.value_or(Loads{}).largest_tension_n;
            return std::abs(largest_n / tension_n - 1.0);
        };
        // Measured 8.9e-13 and 1.2e-14.
        r8.methods[0].bound = r8.methods[1].bound = 2e-12;
        cases.push_back(std::move(r8));
    }
}

void add_r11(std::vector<AccuracyCase>& cases) {
    AccuracyCase& r11 =
        cases.emplace_back(AccuracyCase{"R11", "the source report's start",
                                        "40 particles, tip at 1, 2, 5 and 10 s", "tip / L", report_swing()});
    r11.problem.reference = [fps = r11.problem.fps](std::int64_t k, State& state) {
        for (const reference::PublishedTip& tip : reference::kReportTips) {
            if (fps.time_s(k) == tip.time_s) return set_tip(tip.tip_m, state);
        }
        return false;
    };
    // Measured 3.7e-16, 2.2e-16, 2.3e-17 and 1.5e-4.
    r11.methods = {{"exact, 1e-9", ExactDef{1e-9}, 1e-14},
                   {"exact, 1e-13", ExactDef{1e-13}, 1e-15},
                   {"rattle, order 8", RattleDef{8, 1.0 / 600.0}, 1e-15},
                   {"relaxation, 16 sweeps, 1/960 s", RelaxationDef{1.0 / 960.0, 16}, 2e-4}};
}

}  // namespace

void add_chain_cases(std::vector<AccuracyCase>& cases) {
    add_r4(cases);
    add_r5(cases);
    add_r6(cases);
    add_r7(cases);
    add_r8(cases);
    add_r11(cases);
}

}  // namespace corda::study
