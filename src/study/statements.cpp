#include "corda/study/statements.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace corda::study {
namespace {

constexpr int kReportReach = 7;
/// Figures that differ by less than this share count as equal.
constexpr double kAlike = 0.1;

using Figure = double SwingFigures::*;

bool is_larger(double a, double b) {
    return a > (1.0 + kAlike) * b;
}

/// The runs that went through.
std::vector<const SwingRow*> rows_where(std::span<const SwingRow> rows,
                                        const std::function<bool(const SwingDef&)>& is_wanted) {
    std::vector<const SwingRow*> found;
    for (const SwingRow& row : rows) {
        if (row.figures.failure.empty() && is_wanted(row.def)) found.push_back(&row);
    }
    return found;
}

std::set<double> masses_of(std::span<const SwingRow> rows) {
    std::set<double> masses;
    for (const SwingRow& row : rows) masses.insert(row.def.mass_kg);
    return masses;
}

/// The run with the report's bars; null if it failed.
const SwingRow* find(std::span<const SwingRow> rows, double mass_kg, int sweeps = 1) {
    const auto found = rows_where(rows, [&](const SwingDef& def) {
        return def.mass_kg == mass_kg && def.reach == kReportReach && def.sweeps == sweeps;
    });
    return found.empty() ? nullptr : found.front();
}

/// A figure with the report's bars, from the least mass to the largest.
std::vector<double> over_mass(std::span<const SwingRow> rows, Figure figure) {
    std::vector<double> values;
    for (const double mass_kg : masses_of(rows)) {
        if (const SwingRow* const row = find(rows, mass_kg)) values.push_back(row->figures.*figure);
    }
    return values;
}

bool falls(const std::vector<double>& values) {
    return std::adjacent_find(values.begin(), values.end(), std::less_equal<>()) == values.end();
}

/// The reach with the least figure, and the shortest one whose figure counts as equal.
struct BestReach {
    int best = 0;
    int shortest = 0;
};

/// For each mass.
std::vector<BestReach> best_reaches(std::span<const SwingRow> rows, Figure figure) {
    std::vector<BestReach> reaches;
    for (const double mass_kg : masses_of(rows)) {
        const auto candidates =
            rows_where(rows, [&](const SwingDef& def) { return def.mass_kg == mass_kg && def.sweeps == 1; });
        if (candidates.empty()) continue;
        const SwingRow* const best = *std::min_element(
            candidates.begin(), candidates.end(),
            [&](const auto* a, const auto* b) { return a->figures.*figure < b->figures.*figure; });
        int shortest = best->def.reach;
        for (const SwingRow* const row : candidates) {
            if (!is_larger(row->figures.*figure, best->figures.*figure))
                shortest = std::min(shortest, row->def.reach);
        }
        reaches.push_back({best->def.reach, shortest});
    }
    return reaches;
}

std::vector<int> values_of(const std::vector<BestReach>& reaches, int BestReach::*value) {
    std::vector<int> values;
    for (const BestReach& reach : reaches) values.push_back(reach.*value);
    return values;
}

/// Whether these are the reach that the report found best, give or take one.
std::string verdict(const std::vector<int>& reaches) {
    const auto near = std::count_if(reaches.begin(), reaches.end(),
                                    [](int reach) { return std::abs(reach - kReportReach) <= 1; });
    if (near == static_cast<std::ptrdiff_t>(reaches.size())) return "as the report found";
    if (near == 0) return "unlike the report's finding";
    return "as the report found for some of the masses only";
}

std::string change(const char* what, double from, double to) {
    if (is_larger(to, from)) return fmt::format("{} grows from {:.2g} to {:.2g}", what, from, to);
    if (is_larger(from, to)) return fmt::format("{} falls from {:.2g} to {:.2g}", what, from, to);
    return fmt::format("{} stays near {:.2g}", what, to);
}

}  // namespace

std::string best_reach_statement(std::span<const SwingRow> rows) {
    const auto rope = best_reaches(rows, &SwingFigures::rope_error);
    const auto strain = best_reaches(rows, &SwingFigures::strain);
    const std::vector<int> shortest = values_of(rope, &BestReach::shortest);
    return fmt::format(
        "About 7 n bars were best: with one sweep and masses of {} kg, the motion is nearest to the true "
        "rope with bars of reach {}; the shortest reach with an error at most a tenth larger is {}, {}. For "
        "the largest strain it is {}.",
        fmt::join(masses_of(rows), ", "), fmt::join(values_of(rope, &BestReach::best), ", "),
        fmt::join(shortest, ", "), verdict(shortest),
        fmt::join(values_of(strain, &BestReach::shortest), ", "));
}

std::string mass_statement(std::span<const SwingRow> rows, double difference_under_gravity) {
    constexpr double kRounding = 1e-9;
    const std::vector<double> strains = over_mass(rows, &SwingFigures::strain);
    std::string cause =
        fmt::format("Under gravity mass matters too: the motions of two masses differ by {:.1e} L.",
                    difference_under_gravity);
    if (difference_under_gravity < kRounding) {
        cause = fmt::format(
            "The reason is a force that is the same for every mass. Under gravity, which is proportional to "
            "mass, mass has no effect: the motions of two masses differ by {:.1g} L.",
            difference_under_gravity);
    }
    return fmt::format(
        "More mass makes the rope stiffer: with masses of {} kg the largest strain is {:.2g}, {}. {}",
        fmt::join(masses_of(rows), ", "), fmt::join(strains, ", "),
        falls(strains) ? "as the report found" : "unlike the report's finding", cause);
}

std::string speed_statement(std::span<const SwingRow> rows) {
    const std::set<double> masses_kg = masses_of(rows);
    const std::vector<double> speeds_m_s = over_mass(rows, &SwingFigures::tip_speed_m_s);
    if (speeds_m_s.size() != masses_kg.size()) return "Less mass: a run failed, see the table.";
    std::vector<double> expected_m_s;
    for (const double mass_kg : masses_kg)
        expected_m_s.push_back(speeds_m_s.front() * std::sqrt(*masses_kg.begin() / mass_kg));
    return fmt::format(
        "Less mass makes the rope livelier: with masses of {} kg the tip reaches {:.3g} m/s, {}. In "
        "proportion to one over the square root of the mass, as for the same force, it would be {:.3g} m/s.",
        fmt::join(masses_kg, ", "), fmt::join(speeds_m_s, ", "),
        falls(speeds_m_s) ? "as the report found" : "unlike the report's finding",
        fmt::join(expected_m_s, ", "));
}

std::string light_statement(std::span<const SwingRow> rows) {
    const double lightest_kg = *masses_of(rows).begin();
    const SwingRow* const light = find(rows, lightest_kg);
    const SwingRow* const unit = find(rows, 1.0);
    if (light == nullptr || unit == nullptr) return "With a mass below 1: a run failed, see the table.";
    const double strain_ratio = light->figures.strain / unit->figures.strain;
    const double error_ratio = light->figures.rope_error / unit->figures.rope_error;
    const bool stretches = is_larger(strain_ratio, 1.0);
    const bool errs = is_larger(error_ratio, 1.0);
    std::string text = "the motion does not deteriorate, unlike the report's finding";
    if (stretches && errs) text = "the motion deteriorates, as the report found";
    if (stretches && !errs) text = "the links stretch more, but the motion is no farther from the true rope";
    if (!stretches && errs) text = "the motion is farther from the true rope, but the links stretch no more";
    return fmt::format(
        "With a mass below 1: at {:g} kg {}; the largest strain is {:.2g} times and the error from the true "
        "rope {:.2g} times that at 1 kg.",
        lightest_kg, text, strain_ratio, error_ratio);
}

std::string sweeps_statement(std::span<const SwingRow> rows) {
    int most = 1;
    for (const SwingRow& row : rows) most = std::max(most, row.def.sweeps);
    const SwingRow* const one = find(rows, 1.0);
    const SwingRow* const many = find(rows, 1.0, most);
    if (one == nullptr || many == nullptr) return "More sweeps: a run failed, see the table.";
    const bool becomes_rod = many->figures.rod_error < many->figures.rope_error;
    return fmt::format(
        "More sweeps over 7 n bars at 1 kg: from 1 to {}, {}, and {}; with {} sweeps the motion is nearer to "
        "{}.",
        most, change("the error from the true rope", one->figures.rope_error, many->figures.rope_error),
        change("that from the rigid rod", one->figures.rod_error, many->figures.rod_error), most,
        becomes_rod ? "the rod, because all bars together keep the rope straight" : "the true rope");
}

std::string many_particles_statement(std::span<const SwingRow> rows) {
    const auto strains = [&](int reach) {
        auto found = rows_where(rows, [&](const SwingDef& def) {
            return def.mass_kg == 1.0 && def.reach == reach && def.sweeps == 1;
        });
        std::sort(found.begin(), found.end(),
                  [](const auto* a, const auto* b) { return a->def.particles < b->def.particles; });
        std::vector<double> values;
        for (const SwingRow* const row : found) values.push_back(row->figures.strain);
        return values;
    };
    const std::vector<double> few_bars = strains(1);
    const std::vector<double> many_bars = strains(kReportReach);
    if (few_bars.empty() || many_bars.empty())
        return "Many particles and few bars: a run failed, see the table.";
    const bool with_particles = is_larger(few_bars.back(), few_bars.front());
    const bool with_few_bars = is_larger(few_bars.back(), many_bars.back());
    std::string conclusion = "unlike the report's finding";
    if (with_particles && with_few_bars) conclusion = "as the report found";
    if (with_particles != with_few_bars) conclusion = "which confirms one half of the report's finding";
    return fmt::format(
        "Many particles and few bars: from the smallest rope to the largest, {} with bars between neighbours "
        "only; with 7 n bars the strain of the largest is {:.2g}, {}.",
        change("the largest strain", few_bars.front(), few_bars.back()), many_bars.back(), conclusion);
}

std::string settling_statement(std::span<const Settling> rows, double watched_s) {
    const auto time = [&](const std::optional<double>& settled_s) {
        return settled_s ? fmt::format("after {:.3g} s", *settled_s)
                         : fmt::format("not within {:g} s", watched_s);
    };
    std::string text = "The swing settles to the vertical (within a hundredth of its length):";
    int damped = 0;
    int settled = 0;
    for (const Settling& row : rows) {
        if (row.delta > 0.0) {
            ++damped;
            if (row.relaxation_s) ++settled;
            continue;
        }
        text += fmt::format(" without damping, relaxation {}, a true rope {}.", time(row.relaxation_s),
                            time(row.rope_s));
        if (row.relaxation_s && !row.rope_s)
            text +=
                " What stops it is the energy that the method itself loses, not a force that the report "
                "names.";
        if (!row.relaxation_s && !row.rope_s) text += " Only damping makes them settle.";
    }
    return text + fmt::format(" With damping, {} of {} settle.", settled, damped);
}

std::string rates_statement(std::span<const Rate> rates) {
    double least = HUGE_VAL;
    double most = 0.0;
    for (const Rate& rate : rates) {
        least = std::min(least, rate.measured_1_s / rate.report_1_s);
        most = std::max(most, rate.measured_1_s / rate.report_1_s);
    }
    const Rate& first = rates.front();
    const Rate& last = rates.back();
    return fmt::format(
        "Highest update rates: the same steps with the same bars are {:.0f} to {:.0f} times as fast here as "
        "on the report's machine. From {} to {} particles, the report's rate falls to {:.0f} % and ours to "
        "{:.0f} %.",
        least, most, first.particles, last.particles, 100.0 * last.report_1_s / first.report_1_s,
        100.0 * last.measured_1_s / first.measured_1_s);
}

}  // namespace corda::study
