#include "corda/study/statements.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

namespace corda::study {
namespace {

constexpr int kReportReach = 7;
/// What counts as a change: figures nearer than this share are called alike.
constexpr double kAlike = 0.1;

using Figure = std::function<double(const SwingFigures&)>;

std::set<double> masses_of(std::span<const SwingRow> rows) {
    std::set<double> masses;
    for (const SwingRow& row : rows) masses.insert(row.def.mass_kg);
    return masses;
}

/// The row of these parameters that went through; null where there is none.
const SwingRow* find(std::span<const SwingRow> rows, double mass_kg, int reach, int sweeps) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const SwingRow& row) {
        return row.def.mass_kg == mass_kg && row.def.reach == reach && row.def.sweeps == sweeps &&
               row.figures.failure.empty();
    });
    return found == rows.end() ? nullptr : &*found;
}

/// For one mass and one sweep: the least of a figure, and the fewest bars that come near it.
struct BestReach {
    int best = 0;
    int fewest = 0;  ///< the shortest reach whose figure is within kAlike of the least
};

std::vector<BestReach> best_reaches(std::span<const SwingRow> rows, const Figure& figure) {
    std::vector<BestReach> reaches;
    for (const double mass_kg : masses_of(rows)) {
        std::vector<const SwingRow*> candidates;
        for (const SwingRow& row : rows) {
            if (row.def.mass_kg == mass_kg && row.def.sweeps == 1 && row.figures.failure.empty())
                candidates.push_back(&row);
        }
        if (candidates.empty()) continue;
        const auto less = [&](const SwingRow* a, const SwingRow* b) {
            return figure(a->figures) < figure(b->figures);
        };
        const SwingRow* const best = *std::min_element(candidates.begin(), candidates.end(), less);
        BestReach result{best->def.reach, best->def.reach};
        for (const SwingRow* const row : candidates) {
            if (figure(row->figures) <= (1.0 + kAlike) * figure(best->figures))
                result.fewest = std::min(result.fewest, row->def.reach);
        }
        reaches.push_back(result);
    }
    return reaches;
}

std::vector<int> fewest_of(const std::vector<BestReach>& reaches) {
    std::vector<int> fewest;
    for (const BestReach& reach : reaches) fewest.push_back(reach.fewest);
    return fewest;
}

/// Whether these are the reach that the report found best, give or take one.
std::string verdict(const std::vector<int>& reaches) {
    const auto near = std::count_if(reaches.begin(), reaches.end(),
                                    [](int reach) { return std::abs(reach - kReportReach) <= 1; });
    if (near == static_cast<std::ptrdiff_t>(reaches.size())) return "as the report found";
    if (near == 0) return "against the report's finding";
    return "as the report found for some of the masses alone";
}

std::string grows(double from, double to, const char* what) {
    if (to > (1.0 + kAlike) * from) return fmt::format("{} grows from {:.2g} to {:.2g}", what, from, to);
    if (to < from / (1.0 + kAlike)) return fmt::format("{} falls from {:.2g} to {:.2g}", what, from, to);
    return fmt::format("{} stays near {:.2g}", what, to);
}

}  // namespace

std::string best_reach_statement(std::span<const SwingRow> rows) {
    const auto rope = best_reaches(rows, [](const SwingFigures& f) { return f.rope_error; });
    std::vector<int> best;
    for (const BestReach& reach : rope) best.push_back(reach.best);
    const auto strain = best_reaches(rows, [](const SwingFigures& f) { return f.strain; });
    return fmt::format(
        "About 7 n bars were best: with one pass and masses of {} kg the motion is nearest to the true rope "
        "with "
        "bars to the next {} particles; the fewest bars that come within a tenth of that error reach {}, {}. "
        "The "
        "largest strain needs bars of reach {} for that.",
        fmt::join(masses_of(rows), ", "), fmt::join(best, ", "), fmt::join(fewest_of(rope), ", "),
        verdict(fewest_of(rope)), fmt::join(fewest_of(strain), ", "));
}

std::string mass_statement(std::span<const SwingRow> rows, double difference_under_gravity) {
    std::vector<double> strains;
    for (const double mass_kg : masses_of(rows)) {
        const SwingRow* const row = find(rows, mass_kg, kReportReach, 1);
        if (row != nullptr) strains.push_back(row->figures.strain);
    }
    const bool falls =
        std::adjacent_find(strains.begin(), strains.end(), std::less_equal<>()) == strains.end();
    const std::string trend =
        falls ? "less and less, as the report found" : "not less and less, against the report's finding";
    const std::string apart = difference_under_gravity == 0.0
                                  ? "exactly alike"
                                  : fmt::format("alike to {:.1e} L", difference_under_gravity);
    const std::string no_effect = fmt::format(
        "The reason is the force that is the same for every mass: under gravity, which grows with mass, two "
        "masses "
        "move {}, and mass has no effect at all.",
        apart);
    const std::string effect = fmt::format("Under gravity, too, mass matters: two masses part by {:.1e} L.",
                                           difference_under_gravity);
    const std::string& cause = difference_under_gravity < 1e-9 ? no_effect : effect;
    return fmt::format(
        "More mass makes the rope stiffer: at masses of {} kg the links stretch by {:.2g}, {}. {}",
        fmt::join(masses_of(rows), ", "), fmt::join(strains, ", "), trend, cause);
}

std::string speed_statement(std::span<const SwingRow> rows) {
    std::vector<double> speeds_m_s;
    std::vector<double> expected_m_s;  // the same force: as the root of the mass
    double first_root = 0.0;
    for (const double mass_kg : masses_of(rows)) {
        const SwingRow* const row = find(rows, mass_kg, kReportReach, 1);
        if (row == nullptr) continue;
        speeds_m_s.push_back(row->figures.tip_speed_m_s);
        if (first_root == 0.0) first_root = std::sqrt(mass_kg);
        expected_m_s.push_back(speeds_m_s.front() * first_root / std::sqrt(mass_kg));
    }
    const bool falls =
        std::adjacent_find(speeds_m_s.begin(), speeds_m_s.end(), std::less_equal<>()) == speeds_m_s.end();
    return fmt::format(
        "Less mass is {}: at masses of {} kg the tip gets to {:.3g} m/s; the force being the same, speeds in "
        "proportion to one over the root of the mass would be {:.3g} m/s.",
        falls ? "livelier, as the report found" : "not livelier, against the report's finding",
        fmt::join(masses_of(rows), ", "), fmt::join(speeds_m_s, ", "), fmt::join(expected_m_s, ", "));
}

std::string light_statement(std::span<const SwingRow> rows) {
    const double lightest_kg = *masses_of(rows).begin();
    const SwingRow* const light = find(rows, lightest_kg, kReportReach, 1);
    const SwingRow* const unit = find(rows, 1.0, kReportReach, 1);
    if (light == nullptr || unit == nullptr) return "With a mass below 1: a run failed, see the table.";
    const double strain_ratio = light->figures.strain / unit->figures.strain;
    const double error_ratio = light->figures.rope_error / unit->figures.rope_error;
    const bool stretches = strain_ratio > 1.0 + kAlike;
    const bool errs = error_ratio > 1.0 + kAlike;
    std::string text = "the motion does not deteriorate, against the report's finding";
    if (stretches && errs) text = "the motion deteriorates, as the report found";
    if (stretches != errs)
        text = stretches ? "the links stretch more, yet the motion is no farther from the true rope"
                         : "the motion is farther from the true rope, yet the links stretch no more";
    return fmt::format(
        "With a mass below 1: at {:g} kg {}; the largest strain is {:.2g} times, the error against the true "
        "rope "
        "{:.2g} times that at 1 kg.",
        lightest_kg, text, strain_ratio, error_ratio);
}

std::string sweeps_statement(std::span<const SwingRow> rows) {
    const SwingRow* const one = find(rows, 1.0, kReportReach, 1);
    int most = 1;
    for (const SwingRow& row : rows) most = std::max(most, row.def.sweeps);
    const SwingRow* const many = find(rows, 1.0, kReportReach, most);
    if (one == nullptr || many == nullptr || most == 1) return "More passes: a run failed, see the table.";
    const bool becomes_rod = many->figures.rod_error < many->figures.rope_error;
    return fmt::format(
        "More passes over 7 n bars at 1 kg: from 1 to {}, {}, and {}; with {} passes the motion is nearer to "
        "{}.",
        most, grows(one->figures.rope_error, many->figures.rope_error, "the error against the true rope"),
        grows(one->figures.rod_error, many->figures.rod_error, "that against the rigid rod"), most,
        becomes_rod ? "the rod: the bars together say that the rope is straight" : "the true rope");
}

std::string many_particles_statement(std::span<const SwingRow> rows) {
    const auto strain = [&](bool is_large, int reach) {
        const SwingRow* best = nullptr;
        for (const SwingRow& row : rows) {
            if (row.def.mass_kg != 1.0 || row.def.reach != reach || row.def.sweeps != 1) continue;
            const bool is_better = best == nullptr || (is_large ? row.def.particles > best->def.particles
                                                                : row.def.particles < best->def.particles);
            if (is_better && row.figures.failure.empty()) best = &row;
        }
        return best == nullptr ? std::nan("") : best->figures.strain;
    };
    const double few_small = strain(false, 1);
    const double few_large = strain(true, 1);
    const double many_large = strain(true, kReportReach);
    const bool with_particles = few_large > (1.0 + kAlike) * few_small;
    const bool with_few_bars = few_large > (1.0 + kAlike) * many_large;
    std::string conclusion = "against the report's finding";
    if (with_particles && with_few_bars) conclusion = "as the report found";
    if (with_particles != with_few_bars) conclusion = "which bears out one half of the report's finding";
    return fmt::format(
        "Many particles and few bars: from the smallest to the largest rope {} with bars between neighbours "
        "alone, and the largest rope stretches by {:.2g} with 7 n bars, {}.",
        grows(few_small, few_large, "the largest strain"), many_large, conclusion);
}

std::string settling_statement(std::span<const Settling> rows, double watched_s) {
    const auto time = [&](const std::optional<double>& settled_s) {
        return settled_s ? fmt::format("after {:.3g} s", *settled_s)
                         : fmt::format("not within {:g} s", watched_s);
    };
    std::string text = "The swing settles to the vertical (within a hundredth of its length):";
    for (const Settling& row : rows) {
        if (row.delta != 0.0) continue;
        text += fmt::format(" without damping, relaxation {}, a true rope {}.", time(row.relaxation_s),
                            time(row.rope_s));
        if (row.relaxation_s && !row.rope_s)
            text += " What stills it is the method's own loss, not a force that the report names.";
        if (!row.relaxation_s && !row.rope_s) text += " It takes damping to still either.";
    }
    const auto settled = std::count_if(rows.begin(), rows.end(), [](const Settling& row) {
        return row.delta > 0.0 && row.relaxation_s.has_value();
    });
    const auto damped =
        std::count_if(rows.begin(), rows.end(), [](const Settling& row) { return row.delta > 0.0; });
    return text + fmt::format(" With damping {} of {} settle.", settled, damped);
}

std::string rates_statement(std::span<const Rate> rates) {
    double least = HUGE_VAL;
    double most = 0.0;
    for (const Rate& rate : rates) {
        least = std::min(least, rate.measured_1_s / rate.report_1_s);
        most = std::max(most, rate.measured_1_s / rate.report_1_s);
    }
    return fmt::format(
        "Highest update rates: the same steps with the same bars go {:.0f} to {:.0f} times as fast here as "
        "on the "
        "report's machine; from {} to {} particles the report's rate falls to {:.0f} %, ours to {:.0f} %.",
        least, most, rates.front().particles, rates.back().particles,
        100.0 * rates.back().report_1_s / rates.front().report_1_s,
        100.0 * rates.back().measured_1_s / rates.front().measured_1_s);
}

}  // namespace corda::study
