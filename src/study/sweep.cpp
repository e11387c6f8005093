#include "corda/study/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "corda/sim/planner.hpp"
#include "corda/study/problems.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/slope.hpp"

namespace corda::study {
namespace {

/// A run that would take longer is left out, in seconds.
constexpr double kLongestRun = 0.3;
constexpr double kLongestQuickRun = 0.01;
constexpr int kMostHalvings = 8;
/// Steps a second of relaxation's coarsest run, where that is not longer than a frame.
constexpr double kFewestSteps = 60.0;
/// What the planner's costs leave out: a relaxation step's updates, in nanoseconds a particle.
constexpr double kUpdateCost = 4.0;

/// The fastest of MuJoCo 3.12, Simbody 3.7, Box2D 2.4 and Bullet 3.24 at each accuracy on the source report's
/// swing, and what Corda aims at; ms a simulated second on one core of the machine that the README names.
struct Goal {
    double error;
    double peer_ms;
    double target_ms;
};
constexpr std::array<Goal, 6> kGoals{{{1e-3, 0.94, 0.019},
                                      {1e-4, 3.9, 0.08},
                                      {1e-6, 4.0, 0.08},
                                      {1e-8, 15, 0.3},
                                      {1e-9, 15, 0.3},
                                      {1e-12, 85, 0.85}}};

/// A problem's runs, and what came out.
struct Sweep {
    BuiltInProblem subject;
    std::vector<SweepRun> runs;
    std::vector<Measurement> results;  ///< in the order of runs
    bool has_peers = false;
    [[nodiscard]] const Problem& problem() const { return subject.subject.problem; }
};

double forecast_s(const Problem& problem, const sim::SolverDef& solver, double step_s) {
    const sim::System system = sim::build_system(problem.ropes, problem.nets, solver.reach);
    const double steps = static_cast<double>(problem.last_frame) * problem.frame_interval_s / step_s;
    return 1e-9 * steps *
           (sim::step_cost_ns(system, solver) + kUpdateCost * static_cast<double>(system.particle_count()));
}

std::size_t bars_of(const Problem& problem, int reach) {
    return sim::build_system(problem.ropes, problem.nets, reach).bars.size();
}

void add_relaxation(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const double longest_s = is_quick ? kLongestQuickRun : kLongestRun;
    const double longest_step_s =
        problem.frame_interval_s / std::ceil(problem.frame_interval_s * kFewestSteps - 1e-9);
    for (const int reach : {1, 7}) {
        if (reach > 1 && bars_of(problem, reach) == bars_of(problem, 1)) continue;
        for (const int sweeps : {1, 4, 16, 64}) {
            const std::string label = fmt::format("relaxation, reach {}, sweeps {}", reach, sweeps);
            for (int halving = 0; halving <= kMostHalvings; halving += is_quick ? 2 : 1) {
                const double step_s = std::ldexp(longest_step_s, -halving);
                const sim::SolverDef solver = sim::relaxation_solver(step_s, reach, sweeps);
                if (halving > 0 && forecast_s(problem, solver, step_s) > longest_s) break;
                runs.push_back({solver, label, step_s});
                if (!refusal(problem, solver).empty()) break;
            }
        }
    }
}

void add_rope(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, sim::rope_solver(2)).empty();
    const double longest_s = is_quick ? kLongestQuickRun : kLongestRun;
    for (const int order : {2, 4, 6, 8}) {
        const std::string label = fmt::format("rope, order {}", order);
        if (is_refused) {
            runs.push_back({sim::rope_solver(order), label, problem.frame_interval_s});
            continue;
        }
        const double parts = std::round(problem.frame_interval_s / rope_step_s(problem, order));
        // High orders are at rounding after a few halvings: they take two points to each.
        const int points_per_halving = order >= 6 && !is_quick ? 2 : 1;
        for (int point = 0; point <= kMostHalvings * points_per_halving; ++point) {
            const double finer = std::exp2(static_cast<double>(point) / points_per_halving);
            const double step_s = problem.frame_interval_s / std::round(parts * finer);
            const sim::SolverDef solver = sim::rope_solver(order, step_s);
            if (point > 0 && forecast_s(problem, solver, step_s) > longest_s) break;
            if (order == 8 && finer > 4.0) break;
            if (order == 6 && finer > 16.0) break;
            runs.push_back({solver, label, step_s});
        }
    }
}

void add_exact(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, sim::exact_solver(1e-9)).empty();
    for (int digits = is_quick ? 1 : 0; digits <= 13; digits += is_quick ? 2 : 1) {
        const double tolerance = std::stod(fmt::format("1e-{}", digits));
        runs.push_back({sim::exact_solver(tolerance), "exact", tolerance});
        if (is_refused) break;
    }
}

Cell cell(std::optional<double> value) {
    return value && std::isfinite(*value) ? Cell(*value) : Cell();
}

Table runs_table(const Sweep& sweep) {
    Table table;
    table.id = "speed_" + sweep.problem().id;
    table.title = sweep.problem().title;
    table.columns = {{"series", "method"},
                     {"parameter", "step [s] or tolerance"},
                     {"error_largest_over_length", "largest error / L"},
                     {"error_rms_over_length", "RMS error / L"},
                     {"strain_largest", "largest strain"},
                     {"energy_error_over_mgl", "energy error / (m g L)"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     {"steps", "steps"},
                     {std::string(kFailureKey), "failed because"}};
    for (const Measurement& run : sweep.results) {
        if (!run.failure.empty()) {
            table.rows.push_back({run.label, run.parameter, {}, {}, {}, {}, {}, {}, run.failure});
            continue;
        }
        table.rows.push_back({run.label,
                              run.parameter,
                              cell(run.largest_error),
                              cell(run.rms_error),
                              run.largest_strain,
                              cell(run.energy_error),
                              run.ms_per_simulated_s,
                              static_cast<double>(run.steps),
                              {}});
    }
    table.note =
        "Errors are the largest over the frames: of one particle's distance from the truth, and of the root "
        "mean square over the particles.";
    return table;
}

double slope_between(std::pair<double, double> a, std::pair<double, double> b) {
    return std::log(a.second / b.second) / std::log(a.first / b.first);
}

/// Of one series, errors over parameters as long as they fall and rounding is far. Where they fall much less
/// steeply than just before, rounding has its share in them; under error control they fall unevenly anyhow.
std::vector<std::pair<double, double>> falling_points(const Sweep& sweep, const std::string& label) {
    constexpr double kStillAsSteep = 0.6;
    const double floor = 30.0 * std::max(1e-15, sweep.subject.subject.disagreement.value_or(0.0));
    std::vector<std::pair<double, double>> points;
    for (const Measurement& run : sweep.results) {
        if (run.label != label || !run.failure.empty() || !(run.rms_error < 0.1)) continue;
        const std::pair<double, double> point{run.parameter, run.rms_error};
        const std::size_t count = points.size();
        if (run.rms_error < floor) break;
        if (count > 0 && run.rms_error > 0.9 * points.back().second) break;
        const bool is_even = run.solver.method != sim::Method::kExact;
        if (is_even && count > 1 &&
            slope_between(points[count - 1], point) <
                kStillAsSteep * slope_between(points[count - 2], points[count - 1])) {
            break;
        }
        points.push_back(point);
    }
    return points;
}

std::vector<std::string> labels_of(const Sweep& sweep) {
    std::vector<std::string> labels;
    for (const SweepRun& run : sweep.runs) {
        if (labels.empty() || labels.back() != run.label) labels.push_back(run.label);
    }
    return labels;
}

Table slopes_table(const Sweep& sweep) {
    Table table;
    table.id = "slopes_" + sweep.problem().id;
    table.title = "How the error falls with the step or the tolerance";
    table.columns = {
        {"series", "method"}, {"slope", "RMS error ~ parameter ^"}, {"points", "points of the fit"}};
    for (const std::string& label : labels_of(sweep)) {
        const auto slope = fit_slope(falling_points(sweep, label));
        table.rows.push_back({label, slope ? Cell(slope->exponent) : Cell(),
                              slope ? Cell(static_cast<double>(slope->points)) : Cell()});
    }
    table.note =
        "By least squares over the runs whose error still falls and is well above rounding; none where they "
        "are fewer than three.";
    return table;
}

Table fastest_table(const Sweep& sweep) {
    Table table;
    table.id = "fastest_" + sweep.problem().id;
    table.title = "Fastest at each accuracy";
    table.columns = {{"error_goal", "RMS error / L at most"},
                     {"series", "method"},
                     {"parameter", "step [s] or tolerance"},
                     {"error_rms_over_length", "RMS error / L"},
                     {"ms_per_simulated_s", "ms per simulated second"}};
    if (sweep.has_peers) {
        table.columns.push_back({"peer_ms_per_simulated_s", "best peer, ms"});
        table.columns.push_back({"target_ms_per_simulated_s", "target, ms"});
        table.columns.push_back({"target_met", "target met"});
        table.note =
            "Peers: the fastest of MuJoCo 3.12, Simbody 3.7, Box2D 2.4 and Bullet 3.24 that meets the "
            "accuracy, on one core of the same type of machine.";
    }
    for (const Goal& goal : kGoals) {
        const Measurement* const best = cheapest_within(sweep.results, goal.error);
        std::vector<Cell> row{goal.error};
        if (best != nullptr) {
            row.insert(row.end(), {best->label, best->parameter, best->rms_error, best->ms_per_simulated_s});
        } else {
            row.insert(row.end(), {std::string("none"), {}, {}, {}});
        }
        if (sweep.has_peers) {
            const bool is_met = best != nullptr && best->ms_per_simulated_s <= goal.target_ms;
            row.insert(row.end(), {goal.peer_ms, goal.target_ms, std::string(is_met ? "yes" : "no")});
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

Plot plot_of(const Sweep& sweep) {
    Plot plot;
    plot.id = "speed_" + sweep.problem().id;
    plot.title = sweep.problem().title;
    plot.x_title = "RMS error / L";
    plot.y_title = "ms per simulated second";
    for (const std::string& label : labels_of(sweep)) {
        Series series{label, {}};
        for (const Measurement& run : sweep.results) {
            // A logarithm has no place for an error of 0.
            if (run.label == label && run.failure.empty() && run.rms_error > 0.0)
                series.points.emplace_back(run.rms_error, run.ms_per_simulated_s);
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string truth_paragraph(const Sweep& sweep) {
    const Subject& subject = sweep.subject.subject;
    std::string text = sweep.problem().title + ". Truth: " + sweep.problem().truth + ".";
    if (subject.exact_reference) {
        text += fmt::format(" Method exact itself is held against {}; the two are {:.1e} L apart (RMS).",
                            subject.exact_truth, subject.disagreement.value_or(0.0));
    }
    if (!sweep.subject.published.empty()) {
        text += fmt::format(
            " The published tip positions are within {:.1e} L of the first and {:.1e} L of the second.",
            distance_from_published(facing(subject, sim::Method::kRope), sweep.subject.published),
            distance_from_published(facing(subject, sim::Method::kExact), sweep.subject.published));
    }
    if (subject.horizon_s) {
        text += fmt::format(
            " The motion is chaotic: after {:.3g} s two tight runs part by more than {:.0e} L, and no frame "
            "later than that is compared.",
            *subject.horizon_s, kHorizonDifference);
    }
    return text;
}

std::string fastest_paragraph(const Sweep& sweep) {
    int ahead = 0;
    int met = 0;
    for (const Goal& goal : kGoals) {
        const Measurement* const best = cheapest_within(sweep.results, goal.error);
        if (best == nullptr) continue;
        if (best->ms_per_simulated_s < goal.peer_ms) ++ahead;
        if (best->ms_per_simulated_s <= goal.target_ms) ++met;
    }
    return fmt::format(
        "Of {} accuracies Corda is faster than the best peer at {}, and meets its target at {}.",
        kGoals.size(), ahead, met);
}

/// Orders on motions that show them: R5's 20 links against their published tip at 1 s.
struct Orders {
    struct Run {
        Problem problem;
        SweepRun run;
    };
    std::vector<Run> runs;
    std::vector<Measurement> results;
};

/// A row of R5 with nothing but its end to look at: a frame more often would add steps off the grid.
Problem end_of(const ReleasedChain& row) {
    Problem problem = released_problem(row);
    const Reference reference = problem.reference;
    const std::int64_t last = problem.last_frame;
    problem.frame_interval_s = row.time_s;
    problem.last_frame = 1;
    problem.reference = [reference, last](std::int64_t, sim::State& state) { return reference(last, state); };
    return problem;
}

Orders orders_of_methods() {
    const Problem from_45 = end_of(kReleasedChains[10]);
    const Problem from_90 = end_of(kReleasedChains[12]);
    Orders orders;
    const auto add = [&](const Problem& problem, const std::string& label,
                         std::initializer_list<double> rates, const auto& solver) {
        for (const double rate : rates)
            orders.runs.push_back({problem, {solver(1.0 / rate), label, 1.0 / rate}});
    };
    const auto rope = [](int order) {
        return [order](double step_s) { return sim::rope_solver(order, step_s); };
    };
    for (const int sweeps : {1, 64}) {
        add(from_45, fmt::format("relaxation, reach 1, sweeps {}", sweeps), {1000, 2000, 4000, 8000},
            [sweeps](double step_s) { return sim::relaxation_solver(step_s, 1, sweeps); });
    }
    // Every step is one that the guard leaves whole. From 45 degrees order 8 is at rounding with all of them.
    add(from_45, "rope, order 2", {500, 1000, 2000, 4000}, rope(2));
    add(from_45, "rope, order 4", {320, 500, 800, 1200, 2000}, rope(4));
    add(from_45, "rope, order 6", {320, 400, 500, 640}, rope(6));
    add(from_90, "rope, order 8, from the horizontal", {450, 500, 550, 600, 700}, rope(8));
    return orders;
}

Table orders_table(const Orders& orders) {
    Table table;
    table.id = "orders";
    table.title = "Orders: 20 links from 45 degrees, the tip after 1 s";
    table.columns = {{"series", "method"},
                     {"slope", "error ~ step ^"},
                     {"points", "points of the fit"},
                     {"error_coarsest", "error / L at the longest step"},
                     {"error_finest", "error / L at the shortest step"}};
    for (std::size_t first = 0; first < orders.results.size();) {
        std::size_t end = first;
        std::vector<std::pair<double, double>> points;
        while (end < orders.results.size() && orders.results[end].label == orders.results[first].label) {
            if (orders.results[end].failure.empty())
                points.emplace_back(orders.results[end].parameter, orders.results[end].largest_error);
            ++end;
        }
        const auto slope = fit_slope(points);
        table.rows.push_back({orders.results[first].label, slope ? Cell(slope->exponent) : Cell(),
                              static_cast<double>(points.size()), orders.results[first].largest_error,
                              orders.results[end - 1].largest_error});
        first = end;
    }
    table.note = "Truth: PHYSICS section 4, R5, worked out by others to 20 digits.";
    return table;
}

std::vector<BuiltInProblem> subjects_of(const StudyDef& def) {
    if (!def.problem) return {report_swing(), a01_pendulum(), released_chain(), spinning_chain()};
    BuiltInProblem own;
    own.subject.problem = *def.problem;
    return {own};
}

/// Adds the jobs of a problem's sweep.
void add_jobs(const std::shared_ptr<Sweep>& sweep, const Timing& timing, std::vector<Job>& jobs) {
    jobs.push_back({sweep->problem().id + ": truth", [sweep] {
                        if (!sweep->problem().reference) find_truth(sweep->subject.subject);
                    }});
    for (const SweepRun& run : sweep->runs) {
        jobs.push_back({fmt::format("{}: {}, {:.3g}", sweep->problem().id, run.label, run.parameter),
                        [sweep, run, timing] {
                            const Problem problem = facing(sweep->subject.subject, run.solver.method);
                            sweep->results.push_back(
                                measure(problem, run.solver, run.label, run.parameter, timing));
                        }});
    }
}

void add_sweep(const Sweep& sweep, Chapter& chapter) {
    chapter.paragraphs.push_back(truth_paragraph(sweep));
    if (sweep.has_peers) chapter.paragraphs.push_back(fastest_paragraph(sweep));
    chapter.tables.push_back(fastest_table(sweep));
    chapter.tables.push_back(slopes_table(sweep));
    chapter.tables.push_back(runs_table(sweep));
    chapter.plots.push_back(plot_of(sweep));
}

}  // namespace

std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick) {
    std::vector<SweepRun> runs;
    add_relaxation(problem, is_quick, runs);
    add_rope(problem, is_quick, runs);
    add_exact(problem, is_quick, runs);
    return runs;
}

const Measurement* cheapest_within(std::span<const Measurement> runs, double error) {
    const Measurement* best = nullptr;
    for (const Measurement& run : runs) {
        if (!run.failure.empty() || !(run.rms_error <= error)) continue;
        if (best == nullptr || run.ms_per_simulated_s < best->ms_per_simulated_s) best = &run;
    }
    return best;
}

ChapterWork speed_work(const StudyDef& def) {
    ChapterWork work;
    std::vector<std::shared_ptr<Sweep>> sweeps;
    for (BuiltInProblem& subject : subjects_of(def)) {
        auto sweep = std::make_shared<Sweep>();
        sweep->has_peers = !def.problem && subject.subject.problem.id == "report_swing";
        sweep->subject = std::move(subject);
        sweep->runs = sweep_runs(sweep->problem(), def.quick);
        add_jobs(sweep, study_timing(def.quick), work.jobs);
        sweeps.push_back(std::move(sweep));
    }
    auto orders = std::make_shared<Orders>();
    if (!def.problem) {
        *orders = orders_of_methods();
        work.jobs.push_back({"orders", [orders] {
                                 for (const auto& [problem, run] : orders->runs)
                                     orders->results.push_back(measure(problem, run.solver, run.label,
                                                                       run.parameter, Timing{1, 0.0}));
                             }});
    }
    work.finish = [sweeps, orders, timing = study_timing(def.quick)] {
        Chapter chapter;
        chapter.title = "Speed against error";
        chapter.paragraphs.push_back(
            fmt::format("Every run hands out the positions of all particles at every frame. Its time is that "
                        "of the stepping "
                        "alone, without set-up: the least of {} repeats of at least {:g} ms each "
                        "(CLOCK_MONOTONIC). What a method "
                        "is held against is another one, wherever another one can run the problem.",
                        timing.repeats, 1e3 * timing.shortest_s));
        for (const auto& sweep : sweeps) add_sweep(*sweep, chapter);
        if (!orders->results.empty()) chapter.tables.push_back(orders_table(*orders));
        return chapter;
    };
    return work;
}

}  // namespace corda::study
