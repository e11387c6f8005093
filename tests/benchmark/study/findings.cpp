#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "benchmark/study/chapters.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/swings.hpp"

namespace corda::study {
namespace {

using nlohmann::json;

constexpr std::array<double, 3> kMasses{0.1, 1.0, 10.0};
constexpr int kMaxReach = 10;

std::uint64_t bars_of(const SwingDef& def) {
    return bar_count(static_cast<std::uint64_t>(def.particles), static_cast<std::uint64_t>(def.reach));
}

/// Runs a swing.
json swing_json(const SwingDef& def, const std::vector<State>& truth) {
    const SwingFigures figures = watch_swing(def, truth);
    json row{{"particles", def.particles},
             {"mass_kg", def.mass_kg},
             {"sweeps", def.sweeps},
             {"reach", def.reach},
             {"bars", bars_of(def)}};
    if (!figures.failure.empty()) {
        row["failure"] = figures.failure;
        return row;
    }
    row["strain_largest"] = figures.strain;
    row["rope_error_rms_over_length"] = figures.rope_error;
    row["rod_error_rms_over_length"] = figures.rod_error;
    row["energy_error_over_mgl"] = figures.energy_error;
    row["tip_speed_m_s"] = figures.tip_speed_m_s;
    return row;
}

/// Update rates: the report's, and those of this machine.
json measure_rates(const Options& options, const OnRun& on_run) {
    json rows = json::array();
    for (const auto& [particles, report_1_s] : reference::kReportRates) {
        on_run(fmt::format("update rate of {} particles", particles));
        SwingDef swing;
        swing.particles = particles;
        rows.push_back({{"particles", particles},
                        {"bars", bars_of(swing)},
                        {"report_updates_per_s", report_1_s},
                        {"updates_per_s", updates_per_second(swing, options.timing())}});
    }
    return rows;
}

/// 40 particles of every mass over sweeps and reaches.
json measure_bars(const Options& options, const OnRun& on_run) {
    json rows = json::array();
    for (const double mass_kg : kMasses) {
        const auto truth = true_swing(SwingDef{}.particles, mass_kg);
        for (const int sweeps : {1, 4, 16, 256}) {
            if (options.quick && sweeps == 4) continue;
            for (int reach = 1; reach <= kMaxReach; ++reach) {
                // Many sweeps take long, and are of interest for the report's bars.
                if (sweeps == 256 && (reach != 7 || options.quick)) continue;
                on_run(fmt::format("bars, {:g} kg, {} sweeps, reach {}", mass_kg, sweeps, reach));
                rows.push_back(swing_json({SwingDef{}.particles, mass_kg, reach, sweeps}, truth));
            }
        }
    }
    return rows;
}

json measure_sizes(const OnRun& on_run) {
    json rows = json::array();
    for (const reference::ReportRate& row : reference::kReportRates) {
        on_run(fmt::format("{} particles", row.particles));
        for (const double mass_kg : {0.1, 1.0}) {
            const auto truth = true_swing(row.particles, mass_kg);
            for (const int reach : {1, 3, 7})
                rows.push_back(swing_json({row.particles, mass_kg, reach, 1}, truth));
        }
    }
    return rows;
}

/// Times to settle, watched for `watched_s`, of relaxation and of a true rope with the same drag.
json measure_settling(double watched_s, const OnRun& on_run) {
    json rows = json::array();
    for (const auto& [delta, step_s] : {std::pair{0.0, 1.0 / 60.0},
                                        {0.001, 1.0 / 60.0},
                                        {0.001, 1.0 / 120.0},
                                        {0.005, 1.0 / 60.0},
                                        {0.02, 1.0 / 60.0}}) {
        on_run(fmt::format("settling, delta {:g}", delta));
        RelaxationDef method{step_s};
        method.delta = delta;
        const double drag_1_s = -std::log1p(-delta) / step_s;
        rows.push_back({{"delta", delta},
                        {"step_s", step_s},
                        {"drag_1_s", drag_1_s},
                        {"relaxation_settles_s", json_of(settling_time_s(method, 0.0, watched_s))},
                        {"rope_settles_s", json_of(settling_time_s(ExactDef{1e-8}, drag_1_s, watched_s))}});
    }
    return rows;
}

}  // namespace

json measure_findings(const Options& options, const OnRun& on_run) {
    const double watched_s = options.quick ? 150.0 : 600.0;
    json result{{"rates", measure_rates(options, on_run)},
                {"bars", measure_bars(options, on_run)},
                {"sizes", measure_sizes(on_run)},
                {"watched_s", watched_s},
                {"settling", measure_settling(watched_s, on_run)}};
    on_run("masses under gravity");
    result["masses_under_gravity_kg"] = {kMasses.front(), kMasses.back()};
    result["difference_under_gravity_over_length"] =
        difference_under_gravity(kMasses.front(), kMasses.back());
    return result;
}

}  // namespace corda::study
