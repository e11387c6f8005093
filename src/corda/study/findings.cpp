#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "corda/reference/numbers.hpp"
#include "corda/study/study.hpp"
#include "corda/study/swings.hpp"

namespace corda::study {
namespace {

constexpr std::array<double, 3> kMasses{0.1, 1.0, 10.0};
constexpr int kMaxReach = 10;

/// The tables and plots of the chapter. The jobs fill them.
struct Findings {
    explicit Findings(bool is_quick);

    report::Table rates{"report_rates", "Update rates of the report and of this machine", {}, {}, {}};
    report::Table bars{"bars", "Quality over bars, sweeps and mass", {}, {}, {}};
    report::Table sizes{"particles", "Quality over the number of particles", {}, {}, {}};
    report::Table settling{"settling", "Time to settle to the vertical", {}, {}, {}};
    report::Plot rope_error;
    report::Plot strain;
    double watched_s;  ///< limit of the times to settle
    double difference_under_gravity = 0.0;
};

report::Plot bars_plot(const char* id, const char* title, const char* caption_start) {
    report::Plot plot{id, title, "reach of the bars", title, false, true, {}};
    plot.caption = fmt::format(
        "{} of 40 particles over the reach of the bars. With reach 7, each particle has bars to the next "
        "1, 2, ..., 7 particles. One sweep per step.",
        caption_start);
    for (const double mass_kg : kMasses)
        plot.series.push_back({fmt::format("{:g} kg, one sweep", mass_kg), {}});
    return plot;
}

Findings::Findings(bool is_quick)
    : rope_error(bars_plot("bars_rope_error", "RMS error / L from the true rope",
                           "Distance from the true rope, in lengths (RMS, largest over the frames),")),
      strain(bars_plot("bars_strain", "largest strain", "Largest strain of a link")),
      watched_s(is_quick ? 150.0 : 600.0) {
    rates.columns = {{"particles", "particles"},
                     {"relaxations", "bars"},
                     {"report_updates_per_s", "report: updates per second"},
                     {"updates_per_s", "here: updates per second"}};
    rates.note = "Here on one core and without drawing; the report's machine also drew the rope.";
    bars.columns = {{"particles", "particles"},
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
    bars.note =
        "Two periods of the rigid rod from the report's start, 60 steps per second, a force of (0, -9.8) N "
        "per particle. With reach 7, each particle has bars to the next 1, 2, ..., 7 particles.";
    sizes.columns = bars.columns;
    sizes.note = bars.note;
    settling.columns = {{"delta", "delta per step"},
                        {"step_s", "step [s]"},
                        {"drag_1_s", "drag [1/s]"},
                        {"relaxation_settles_s", "relaxation, reach 7 [s]"},
                        {"rope_settles_s", "true rope with that drag [s]"}};
    settling.note = fmt::format(
        "From then on, no particle is farther than a hundredth of the length from the vertical; empty if "
        "that takes more than {:g} s. delta acts per step: half the step doubles the drag.",
        watched_s);
}

double bars_of(const SwingDef& def) {
    return static_cast<double>(
        bar_count(static_cast<std::uint64_t>(def.particles), static_cast<std::uint64_t>(def.reach)));
}

/// Runs a swing and adds its row.
SwingFigures add_swing(const SwingDef& def, const std::vector<State>& truth, report::Table& table) {
    SwingFigures figures = watch_swing(def, truth);
    std::vector<report::Cell> cells{static_cast<double>(def.particles), def.mass_kg,
                                    static_cast<double>(def.sweeps), static_cast<double>(def.reach),
                                    bars_of(def)};
    if (!figures.failure.empty()) {
        table.add_failed(std::move(cells), figures.failure);
        return figures;
    }
    cells.insert(cells.end(), {figures.strain, figures.rope_error, figures.rod_error, figures.energy_error,
                               figures.tip_speed_m_s});
    table.add(std::move(cells));
    return figures;
}

/// 40 particles of a mass over sweeps and reaches.
void run_bars(std::size_t mass, bool is_quick, Findings& findings) {
    const double mass_kg = kMasses.at(mass);
    const auto truth = true_swing(SwingDef{}.particles, mass_kg);
    for (const int sweeps : {1, 4, 16, 256}) {
        if (is_quick && sweeps == 4) continue;
        for (int reach = 1; reach <= kMaxReach; ++reach) {
            // Many sweeps take long, and are of interest for the report's bars.
            if (sweeps == 256 && (reach != 7 || is_quick)) continue;
            const SwingFigures figures =
                add_swing({SwingDef{}.particles, mass_kg, reach, sweeps}, truth, findings.bars);
            if (sweeps != 1 || !figures.failure.empty()) continue;
            findings.rope_error.series[mass].points.emplace_back(reach, figures.rope_error);
            findings.strain.series[mass].points.emplace_back(reach, figures.strain);
        }
    }
}

void run_sizes(int particles, Findings& findings) {
    for (const double mass_kg : {0.1, 1.0}) {
        const auto truth = true_swing(particles, mass_kg);
        for (const int reach : {1, 3, 7})
            static_cast<void>(add_swing({particles, mass_kg, reach, 1}, truth, findings.sizes));
    }
}

void run_settling(double delta, double step_s, Findings& findings) {
    RelaxationDef method{step_s};
    method.delta = delta;
    const double drag_1_s = -std::log1p(-delta) / step_s;
    findings.settling.add({delta, step_s, drag_1_s,
                           report::cell_of(settling_time_s(method, 0.0, findings.watched_s)),
                           report::cell_of(settling_time_s(ExactDef{1e-8}, drag_1_s, findings.watched_s))});
}

report::Chapter chapter_of(const Findings& findings) {
    report::Chapter chapter{.title = "The source report's findings"};
    chapter.paragraphs = {
        "The report's start and method: bars of reach 7, one sweep per step, a force of 9.8 N per particle. "
        "They are compared with the motion of a true rope, by method exact, and with that of a rigid rod, in "
        "closed form.",
        fmt::format("Mass matters because the force is the same for every mass. Under gravity, which is "
                    "proportional to mass, the motions of {:g} kg and {:g} kg differ by {:.1g} L.",
                    kMasses.front(), kMasses.back(), findings.difference_under_gravity)};
    chapter.tables = {findings.rates, findings.bars, findings.sizes, findings.settling};
    chapter.plots = {findings.rope_error, findings.strain};
    return chapter;
}

}  // namespace

ChapterWork findings_work(const StudyDef& def) {
    const auto findings = std::make_shared<Findings>(def.quick);
    ChapterWork work;
    const auto add = [&work](std::string what, std::function<void()> run) {
        work.jobs.push_back({std::move(what), std::move(run)});
    };
    for (const auto& [particles, report_1_s] : reference::kReportRates) {
        SwingDef swing;
        swing.particles = particles;
        add(fmt::format("update rate of {} particles", particles),
            [=, report_1_s = report_1_s, timing = study_timing(def.quick)] {
                findings->rates.add({static_cast<double>(swing.particles), bars_of(swing), report_1_s,
                                     updates_per_second(swing, timing)});
            });
    }
    for (std::size_t mass = 0; mass < kMasses.size(); ++mass) {
        add(fmt::format("bars, {:g} kg", kMasses.at(mass)),
            [=, is_quick = def.quick] { run_bars(mass, is_quick, *findings); });
    }
    for (const reference::ReportRate& row : reference::kReportRates)
        add(fmt::format("{} particles", row.particles), [=] { run_sizes(row.particles, *findings); });
    for (const auto& [delta, step_s] : {std::pair{0.0, 1.0 / 60.0},
                                        {0.001, 1.0 / 60.0},
                                        {0.001, 1.0 / 120.0},
                                        {0.005, 1.0 / 60.0},
                                        {0.02, 1.0 / 60.0}}) {
        add(fmt::format("settling, delta {:g}", delta),
            [=, delta = delta, step_s = step_s] { run_settling(delta, step_s, *findings); });
    }
    add("masses under gravity", [findings] {
        findings->difference_under_gravity = difference_under_gravity(kMasses.front(), kMasses.back());
    });
    work.finish = [findings] { return chapter_of(*findings); };
    return work;
}

}  // namespace corda::study
