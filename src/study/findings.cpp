#include "corda/study/findings.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "corda/sim/system.hpp"
#include "corda/study/statements.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {
namespace {

/// The report's own table.
struct ReportRow {
    int particles;
    int bars;
    double rate_1_s;
};
constexpr std::array<ReportRow, 4> kReportRows{
    {{20, 112, 610}, {40, 252, 270}, {80, 532, 140}, {100, 672, 115}}};

constexpr std::array<double, 3> kMasses{0.1, 1.0, 10.0};
constexpr int kLongestReach = 10;

struct Findings {
    std::vector<Rate> rates;
    std::vector<SwingRow> bars;   ///< 40 particles over masses, sweeps, reaches
    std::vector<SwingRow> sizes;  ///< over numbers of particles
    std::vector<Settling> settling;
    double watched_s = 0.0;
    double difference_under_gravity = 0.0;
};

double bars_of(const SwingDef& def) {
    return static_cast<double>(
        sim::bar_count(static_cast<std::uint64_t>(def.particles), static_cast<std::uint64_t>(def.reach)));
}

Table rates_table(const Findings& findings) {
    Table table{"report_rates", "The report's own table beside ours", {}, {}, {}};
    table.columns = {{"particles", "particles"},
                     {"report_relaxations", "report: relaxations an iteration"},
                     {"relaxations", "ours: relaxations an iteration"},
                     {"report_updates_per_s", "report: updates a second"},
                     {"updates_per_s", "ours: updates a second"}};
    for (std::size_t k = 0; k < findings.rates.size(); ++k) {
        SwingDef def;
        def.particles = kReportRows[k].particles;
        table.rows.push_back({static_cast<double>(def.particles), static_cast<double>(kReportRows[k].bars),
                              bars_of(def), kReportRows[k].rate_1_s, findings.rates[k].measured_1_s});
    }
    table.note = "Without drawing, one core; the report's machine drew its rope as well.";
    return table;
}

std::vector<Cell> swing_row(const SwingRow& row) {
    const SwingDef& def = row.def;
    std::vector<Cell> cells{static_cast<double>(def.particles), def.mass_kg, static_cast<double>(def.sweeps),
                            static_cast<double>(def.reach), bars_of(def)};
    if (!row.figures.failure.empty()) {
        cells.insert(cells.end(), {{}, {}, {}, {}, {}, row.figures.failure});
        return cells;
    }
    const SwingFigures& figures = row.figures;
    cells.insert(cells.end(), {figures.strain,
                               figures.rope_error,
                               figures.rod_error,
                               figures.energy_lost,
                               figures.tip_speed_m_s,
                               {}});
    return cells;
}

Table swings_table(std::string id, std::string title, const std::vector<SwingRow>& rows) {
    Table table{std::move(id), std::move(title), {}, {}, {}};
    table.columns = {{"particles", "particles"},
                     {"mass_kg", "mass [kg]"},
                     {"sweeps", "sweeps"},
                     {"reach", "reach"},
                     {"bars", "bars"},
                     {"strain_largest", "largest strain"},
                     {"rope_error_rms_over_length", "RMS error / L, true rope"},
                     {"rod_error_rms_over_length", "RMS error / L, rigid rod"},
                     {"energy_lost_per_swing", "energy lost a swing"},
                     {"tip_speed_m_s", "largest speed of the tip [m/s]"},
                     {std::string(kFailureKey), "failed because"}};
    for (const SwingRow& row : rows) table.rows.push_back(swing_row(row));
    table.note =
        "Two periods of the rigid rod from the report's start, 60 steps a second, a force of (0, -9.8) N on "
        "every particle. Energy in parts of the swing's above hanging at rest.";
    return table;
}

Table settling_table(const Findings& findings) {
    Table table{"settling", "Time to settle to the vertical", {}, {}, {}};
    table.columns = {{"delta", "delta a step"},
                     {"step_s", "step [s]"},
                     {"drag_1_s", "drag rate [1/s]"},
                     {"relaxation_settles_s", "relaxation, 7 n bars [s]"},
                     {"rope_settles_s", "true rope with that drag [s]"}};
    for (const Settling& row : findings.settling) {
        table.rows.push_back(
            {row.delta, row.step_s, row.drag_1_s, cell_of(row.relaxation_s), cell_of(row.rope_s)});
    }
    table.note = fmt::format(
        "Until no particle is farther than a hundredth of the length from the vertical again; empty where "
        "that "
        "takes more than {:g} s. delta is per step: at half the step its drag rate doubles.",
        findings.watched_s);
    return table;
}

Plot bars_plot(const Findings& findings, const char* id, const char* title, double SwingFigures::*figure) {
    Plot plot{id, title, "reach of the bars", "", false, true, {}};
    plot.y_title = title;
    for (const double mass_kg : kMasses) {
        Series series{fmt::format("{:g} kg, one pass", mass_kg), {}};
        for (const SwingRow& row : findings.bars) {
            if (row.def.mass_kg != mass_kg || row.def.sweeps != 1 || !row.figures.failure.empty()) continue;
            series.points.emplace_back(row.def.reach, row.figures.*figure);
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

using Shared = std::shared_ptr<Findings>;

void add_rates(const Shared& findings, bool is_quick, std::vector<Job>& jobs) {
    for (const ReportRow& row : kReportRows) {
        jobs.push_back({fmt::format("update rate of {} particles", row.particles), [=] {
                            findings->rates.push_back(
                                {row.particles, row.rate_1_s,
                                 updates_per_second(row.particles, is_quick ? 0.005 : 0.05)});
                        }});
    }
}

void add_bars(const Shared& findings, bool is_quick, std::vector<Job>& jobs) {
    for (const double mass_kg : kMasses) {
        jobs.push_back({fmt::format("bars, {:g} kg", mass_kg), [=] {
                            const auto truth = true_swing(SwingDef{}.particles, mass_kg);
                            for (const int sweeps : {1, 4, 16, 256}) {
                                if (is_quick && sweeps == 4) continue;
                                for (int reach = 1; reach <= kLongestReach; ++reach) {
                                    // Many passes take long, and say most where the bars are the report's.
                                    if (sweeps == 256 && (reach != 7 || is_quick)) continue;
                                    const SwingDef def{SwingDef{}.particles, mass_kg, reach, sweeps};
                                    findings->bars.push_back({def, watch_swing(def, truth)});
                                }
                            }
                        }});
    }
}

void add_sizes(const Shared& findings, std::vector<Job>& jobs) {
    for (const ReportRow& row : kReportRows) {
        jobs.push_back({fmt::format("{} particles", row.particles), [=] {
                            for (const double mass_kg : {0.1, 1.0}) {
                                const auto truth = true_swing(row.particles, mass_kg);
                                for (const int reach : {1, 3, 7}) {
                                    const SwingDef def{row.particles, mass_kg, reach, 1};
                                    findings->sizes.push_back({def, watch_swing(def, truth)});
                                }
                            }
                        }});
    }
}

void add_settling(const Shared& findings, bool is_quick, std::vector<Job>& jobs) {
    findings->watched_s = is_quick ? 150.0 : 600.0;
    for (const auto& [delta, step_s] : {std::pair{0.0, 1.0 / 60.0},
                                        {0.001, 1.0 / 60.0},
                                        {0.001, 1.0 / 120.0},
                                        {0.005, 1.0 / 60.0},
                                        {0.02, 1.0 / 60.0}}) {
        jobs.push_back({fmt::format("settling, delta {:g}", delta), [=, delta = delta, step_s = step_s] {
                            sim::SolverDef method = sim::relaxation_solver(step_s, 7, 1);
                            method.delta = delta;
                            const double drag_1_s = -std::log1p(-delta) / step_s;
                            findings->settling.push_back(
                                {delta, step_s, drag_1_s, settling_time_s(method, 0.0, findings->watched_s),
                                 settling_time_s(sim::exact_solver(1e-8), drag_1_s, findings->watched_s)});
                        }});
    }
}

Chapter chapter_of(const Findings& findings) {
    Chapter chapter;
    chapter.title = "The source report's findings";
    const std::string setting =
        "The report's start and method (bars of reach 7, one pass a step, a force of 9.8 N on every "
        "particle), "
        "measured against the motion of a true rope by method exact and of a rigid rod in closed form.";
    chapter.paragraphs = {setting,
                          rates_statement(findings.rates),
                          best_reach_statement(findings.bars),
                          sweeps_statement(findings.bars),
                          mass_statement(findings.bars, findings.difference_under_gravity),
                          speed_statement(findings.bars),
                          light_statement(findings.bars),
                          many_particles_statement(findings.sizes),
                          settling_statement(findings.settling, findings.watched_s)};
    chapter.tables = {rates_table(findings),
                      swings_table("bars", "Quality against bars, sweeps and mass", findings.bars),
                      swings_table("particles", "Quality against the number of particles", findings.sizes),
                      settling_table(findings)};
    chapter.plots = {bars_plot(findings, "bars_rope_error", "RMS error / L against the true rope",
                               &SwingFigures::rope_error),
                     bars_plot(findings, "bars_strain", "largest strain", &SwingFigures::strain)};
    return chapter;
}

}  // namespace

ChapterWork findings_work(const StudyDef& def) {
    ChapterWork work;
    const auto findings = std::make_shared<Findings>();
    add_rates(findings, def.quick, work.jobs);
    add_bars(findings, def.quick, work.jobs);
    add_sizes(findings, work.jobs);
    add_settling(findings, def.quick, work.jobs);
    work.jobs.push_back({"masses under gravity", [findings] {
                             findings->difference_under_gravity =
                                 difference_under_gravity(kMasses.front(), kMasses.back());
                         }});
    work.finish = [findings] { return chapter_of(*findings); };
    return work;
}

}  // namespace corda::study
