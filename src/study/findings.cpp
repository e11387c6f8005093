#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "corda/reference/numbers.hpp"
#include "corda/study/study.hpp"
#include "corda/study/swings.hpp"

namespace corda::study {
namespace {

constexpr std::array<double, 3> kMasses{0.1, 1.0, 10.0};
constexpr int kMaxReach = 10;

/// Times to settle of relaxation and of the true rope with the same drag; std::nullopt: not while watched.
struct Settling {
    double delta = 0.0;
    double step_s = 0.0;
    double drag_1_s = 0.0;  ///< -ln(1 - delta) / step
    std::optional<double> relaxation_s;
    std::optional<double> rope_s;
};

/// The report's highest update rate and that of this machine.
struct Rate {
    int particles = 0;
    double report_1_s = 0.0;
    double measured_1_s = 0.0;
};

struct Findings {
    std::vector<Rate> rates;
    std::vector<SwingRow> bars;   ///< 40 particles over masses, sweeps and reaches
    std::vector<SwingRow> sizes;  ///< over numbers of particles
    std::vector<Settling> settling;
    double watched_s = 0.0;
    double difference_under_gravity = 0.0;
};

double bars_of(const SwingDef& def) {
    return static_cast<double>(
        bar_count(static_cast<std::uint64_t>(def.particles), static_cast<std::uint64_t>(def.reach)));
}

report::Table rates_table(const Findings& findings) {
    report::Table table{"report_rates", "Update rates of the report and of this machine", {}, {}, {}};
    table.columns = {{"particles", "particles"},
                     {"relaxations", "bars"},
                     {"report_updates_per_s", "report: updates per second"},
                     {"updates_per_s", "here: updates per second"}};
    for (const Rate& rate : findings.rates) {
        SwingDef def;
        def.particles = rate.particles;
        table.add({static_cast<double>(rate.particles), bars_of(def), rate.report_1_s, rate.measured_1_s});
    }
    table.note = "Here on one core and without drawing; the report's machine also drew the rope.";
    return table;
}

report::Table swings_table(std::string id, std::string title, const std::vector<SwingRow>& rows) {
    report::Table table{std::move(id), std::move(title), {}, {}, {}};
    table.columns = {{"particles", "particles"},
                     {"mass_kg", "mass [kg]"},
                     {"sweeps", "sweeps"},
                     {"reach", "reach"},
                     {"bars", "bars"},
                     {"strain_largest", "largest strain"},
                     {"rope_error_rms_over_length", "RMS error / L, true rope"},
                     {"rod_error_rms_over_length", "RMS error / L, rigid rod"},
                     {"energy_error_over_mgl", "energy error / (m g L)"},
                     {"tip_speed_m_s", "largest speed of the tip [m/s]"},
                     report::failure_column()};
    for (const auto& [def, figures] : rows) {
        std::vector<report::Cell> cells{static_cast<double>(def.particles), def.mass_kg,
                                        static_cast<double>(def.sweeps), static_cast<double>(def.reach),
                                        bars_of(def)};
        if (!figures.failure.empty()) {
            table.add_failed(std::move(cells), figures.failure);
            continue;
        }
        cells.insert(cells.end(), {figures.strain, figures.rope_error, figures.rod_error,
                                   figures.energy_error, figures.tip_speed_m_s});
        table.add(std::move(cells));
    }
    table.note =
        "Two periods of the rigid rod from the report's start, 60 steps per second, a force of (0, -9.8) N "
        "per particle. With reach 7, each particle has bars to the next 1, 2, ..., 7 particles.";
    return table;
}

report::Table settling_table(const Findings& findings) {
    report::Table table{"settling", "Time to settle to the vertical", {}, {}, {}};
    table.columns = {{"delta", "delta per step"},
                     {"step_s", "step [s]"},
                     {"drag_1_s", "drag [1/s]"},
                     {"relaxation_settles_s", "relaxation, reach 7 [s]"},
                     {"rope_settles_s", "true rope with that drag [s]"}};
    for (const Settling& row : findings.settling) {
        table.add({row.delta, row.step_s, row.drag_1_s, report::cell_of(row.relaxation_s),
                   report::cell_of(row.rope_s)});
    }
    table.note = fmt::format(
        "From then on, no particle is farther than a hundredth of the length from the vertical; empty if "
        "that takes more than {:g} s. delta acts per step: half the step doubles the drag.",
        findings.watched_s);
    return table;
}

report::Plot bars_plot(const Findings& findings, const char* id, const char* title, const char* caption_start,
                       double SwingFigures::*figure) {
    report::Plot plot{id, title, "reach of the bars", title, false, true, {}};
    plot.caption = fmt::format(
        "{} of 40 particles over the reach of the bars. With reach 7, each particle has bars to the next "
        "1, 2, ..., 7 particles. One sweep per step.",
        caption_start);
    for (const double mass_kg : kMasses) {
        report::Series series{fmt::format("{:g} kg, one sweep", mass_kg), {}};
        for (const SwingRow& row : findings.bars) {
            if (row.def.mass_kg != mass_kg || row.def.sweeps != 1 || !row.figures.failure.empty()) continue;
            series.points.emplace_back(row.def.reach, row.figures.*figure);
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

using Shared = std::shared_ptr<Findings>;

void add_rates(const Shared& findings, const Timing& timing, std::vector<Job>& jobs) {
    for (const auto& [particles, report_1_s] : reference::kReportRates) {
        SwingDef def;
        def.particles = particles;
        jobs.push_back(
            {fmt::format("update rate of {} particles", particles), [=, report_1_s = report_1_s] {
                 findings->rates.push_back({def.particles, report_1_s, updates_per_second(def, timing)});
             }});
    }
}

void add_bars(const Shared& findings, bool is_quick, std::vector<Job>& jobs) {
    for (const double mass_kg : kMasses) {
        jobs.push_back({fmt::format("bars, {:g} kg", mass_kg), [=] {
                            const auto truth = true_swing(SwingDef{}.particles, mass_kg);
                            for (const int sweeps : {1, 4, 16, 256}) {
                                if (is_quick && sweeps == 4) continue;
                                for (int reach = 1; reach <= kMaxReach; ++reach) {
                                    // Many sweeps take long, and are of interest for the report's bars.
                                    if (sweeps == 256 && (reach != 7 || is_quick)) continue;
                                    const SwingDef def{SwingDef{}.particles, mass_kg, reach, sweeps};
                                    findings->bars.push_back({def, watch_swing(def, truth)});
                                }
                            }
                        }});
    }
}

void add_sizes(const Shared& findings, std::vector<Job>& jobs) {
    for (const reference::ReportRate& row : reference::kReportRates) {
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

void add_settling(const Shared& findings, std::vector<Job>& jobs) {
    struct Damping {
        double delta;
        double step_s;
    };
    for (const auto& [delta, step_s] :
         {Damping{0.0, 1.0 / 60.0}, Damping{0.001, 1.0 / 60.0}, Damping{0.001, 1.0 / 120.0},
          Damping{0.005, 1.0 / 60.0}, Damping{0.02, 1.0 / 60.0}}) {
        RelaxationDef method{step_s};
        method.delta = delta;
        jobs.push_back({fmt::format("settling, delta {:g}", delta), [=, step_s = step_s] {
                            const double drag_1_s = -std::log1p(-method.delta) / step_s;
                            const double watched_s = findings->watched_s;
                            findings->settling.push_back(
                                {method.delta, step_s, drag_1_s, settling_time_s(method, 0.0, watched_s),
                                 settling_time_s(ExactDef{1e-8}, drag_1_s, watched_s)});
                        }});
    }
}

report::Chapter chapter_of(const Findings& findings) {
    report::Chapter chapter;
    chapter.title = "The source report's findings";
    chapter.paragraphs = {
        "The report's start and method: bars of reach 7, one sweep per step, a force of 9.8 N per particle. "
        "They are compared with the motion of a true rope, by method exact, and with that of a rigid rod, in "
        "closed form.",
        fmt::format("Mass matters because the force is the same for every mass. Under gravity, which is "
                    "proportional to mass, the motions of {:g} kg and {:g} kg differ by {:.1g} L.",
                    kMasses.front(), kMasses.back(), findings.difference_under_gravity)};
    chapter.tables = {rates_table(findings),
                      swings_table("bars", "Quality over bars, sweeps and mass", findings.bars),
                      swings_table("particles", "Quality over the number of particles", findings.sizes),
                      settling_table(findings)};
    chapter.plots = {bars_plot(findings, "bars_rope_error", "RMS error / L from the true rope",
                               "Distance from the true rope, in lengths (RMS, largest over the frames),",
                               &SwingFigures::rope_error),
                     bars_plot(findings, "bars_strain", "largest strain", "Largest strain of a link",
                               &SwingFigures::strain)};
    return chapter;
}

}  // namespace

ChapterWork findings_work(const StudyDef& def) {
    ChapterWork work;
    const auto findings = std::make_shared<Findings>();
    findings->watched_s = def.quick ? 150.0 : 600.0;
    add_rates(findings, study_timing(def.quick), work.jobs);
    add_bars(findings, def.quick, work.jobs);
    add_sizes(findings, work.jobs);
    add_settling(findings, work.jobs);
    work.jobs.push_back({"masses under gravity", [findings] {
                             findings->difference_under_gravity =
                                 difference_under_gravity(kMasses.front(), kMasses.back());
                         }});
    work.finish = [findings] { return chapter_of(*findings); };
    return work;
}

}  // namespace corda::study
