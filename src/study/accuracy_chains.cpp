// R4 to R8 and R11 (section 4 of src/sim/README.md).

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/sim/defs.hpp"
#include "corda/study/accuracy.hpp"
#include "corda/study/problems.hpp"

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

void add_r4(bool /*is_quick*/, std::vector<AccuracyRow>& rows) {
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-13", ExactDef{1e-13}}, {"rattle, order 8", RattleDef{8, 1.0 / 4000.0}}}};
    for (const reference::SmallOscillation& row : reference::kSmallOscillations) {
        const Mode mode = mode_of(row.links, row.omega_1_s, row.tip_mass_kg);
        const std::string title = fmt::format("N = {}, tip mass {:g} kg, omega {:.6g} / s", row.links,
                                              row.tip_mass_kg, row.omega_1_s);
        const AccuracyRow named{"R4", title, "frequency, relative"};
        // After a quarter of its period a mode passes zero.
        const double time_s = 0.5 * std::numbers::pi / row.omega_1_s;
        const auto error_of = [&](Probe& probe) {
            probe.go(time_s);
            return std::abs(probe.state().x_m[mode.widest]) / kAmplitude / (0.5 * std::numbers::pi);
        };
        add_probe_rows(named, mode.rope, WorldDef{}, methods, time_s, error_of, rows);
    }
}

void add_r5(bool is_quick, std::vector<AccuracyRow>& rows) {
    for (const reference::ReleasedChain& row : reference::kReleasedChains) {
        const Problem problem = released_problem(row);
        AccuracyRow named{"R5", fmt::format("N = {}, {:g} deg, {:g} s", row.links, row.angle_deg, row.time_s),
                          row.tip_mass_kg > 1.0 ? "tip / L, heavy tip" : "tip / L"};
        if (row.tip_mass_kg != 1.0) named.title += fmt::format(", tip mass {:g} kg", row.tip_mass_kg);
        const double step_s = row.tip_mass_kg > 1.0 ? 1.0 / 7680.0 : 1.0 / 1920.0;
        const std::array<NamedMethod, 3> methods{{{"exact, 1e-9", ExactDef{1e-9}},
                                                  {"exact, 1e-13", ExactDef{1e-13}},
                                                  {"rattle, order 8", RattleDef{8, step_s}}}};
        add_problem_rows(named, problem, methods, study_timing(is_quick), rows);
    }
}

void add_r6(bool /*is_quick*/, std::vector<AccuracyRow>& rows) {
    constexpr double kDragSettles = 8.0;
    constexpr double kSettledSeconds = 20.0;
    const WorldDef world{{0.0, -reference::kGravity}, kSettledSeconds, kDragSettles};
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-9", ExactDef{1e-9}}, {"rattle, order 4", RattleDef{4}}}};
    for (const reference::HangingChain& row : reference::kHangingChains) {
        const AccuracyRow named{"R6", fmt::format("N = {}", row.links),
                                "tension, relative; lowest point / span"};
        const auto error_of = [&](Probe& probe) {
            probe.go(kSettledSeconds);
            const double pull = probe.figures().loads.value_or(Loads{}).pin_force_n / reference::kGravity;
            const double half_weight = 0.5 * (row.links - 1);
            const double tension = std::sqrt(std::max(0.0, pull * pull - half_weight * half_weight));
            const auto& y_m = probe.state().y_m;
            const double lowest_m = *std::min_element(y_m.begin(), y_m.end());
            return std::max(std::abs(tension / row.tension_over_weight - 1.0),
                            std::abs(lowest_m - row.lowest_m));
        };
        add_probe_rows(named, reference::slack_rope(row.links), world, methods, kSettledSeconds, error_of,
                       rows);
    }
}

void add_r7(bool /*is_quick*/, std::vector<AccuracyRow>& rows) {
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-9", ExactDef{1e-9}}, {"rattle, order 8", RattleDef{8, 1.0 / 4000.0}}}};
    for (const reference::FoldedChain& row : reference::kFoldedChains) {
        const AccuracyRow named{"R7", fmt::format("{} links", row.links), "times of the fall, relative"};
        const auto error_of = [&](Probe& probe) {
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
        add_probe_rows(named, reference::folded_rope(row.links), WorldDef{}, methods, row.times_s[2],
                       error_of, rows);
    }
}

void add_r8(bool is_quick, std::vector<AccuracyRow>& rows) {
    const Problem problem = spinning_chain();
    AccuracyRow named{"R8", "N = 10, 3 / s, 10 s", "position / L"};
    const std::array<NamedMethod, 2> methods{
        {{"exact, 1e-9", ExactDef{1e-9}}, {"rattle, order 8", RattleDef{8}}}};
    add_problem_rows(named, problem, methods, study_timing(is_quick), rows);
    named.quantity = "largest tension, relative";
    const auto error_of = [](Probe& probe) {
        constexpr double kTension = 3.0 * 3.0 * 0.1 * 55.0;  // m omega^2 a (1 + ... + 10)
        probe.go_by_frames(10.0);
        const double tension_n = probe.diagnostics().largest.loads.value_or(Loads{}).largest_tension_n;
        return std::abs(tension_n / kTension - 1.0);
    };
    add_probe_rows(named, problem.ropes.front(), problem.world, methods, 10.0, error_of, rows);
}

void add_r11(bool is_quick, std::vector<AccuracyRow>& rows) {
    Problem problem = report_swing();
    problem.reference = [fps = problem.fps](std::int64_t k, State& state) {
        for (const reference::PublishedTip& tip : reference::kReportTips) {
            if (fps.time_s(k) != tip.time_s) continue;
            std::fill(state.x_m.begin(), state.x_m.end(), std::numeric_limits<double>::quiet_NaN());
            state.x_m.back() = tip.tip_m.x;
            state.y_m.back() = tip.tip_m.y;
            return true;
        }
        return false;
    };
    const AccuracyRow named{"R11", "40 particles, tip at 1, 2, 5 and 10 s", "tip / L"};
    const std::array<NamedMethod, 4> methods{
        {{"exact, 1e-9", ExactDef{1e-9}},
         {"exact, 1e-13", ExactDef{1e-13}},
         {"rattle, order 8", RattleDef{8, 1.0 / 600.0}},
         {"relaxation, 16 sweeps, 1/960 s", RelaxationDef{1.0 / 960.0, 16}}}};
    add_problem_rows(named, problem, methods, study_timing(is_quick), rows);
}

}  // namespace

std::vector<AccuracyCase> chain_cases() {
    return {{"R4", "small oscillations", add_r4},       {"R5", "released chains", add_r5},
            {"R6", "hanging between two pins", add_r6}, {"R7", "falling folded chain, 7 digits", add_r7},
            {"R8", "spinning chain", add_r8},           {"R11", "the source report's start", add_r11}};
}

}  // namespace corda::study
