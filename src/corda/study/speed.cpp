#include "corda/study/speed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "corda/sim/rattle/rattle.hpp"
#include "corda/sim/solver.hpp"
#include "corda/study/problems.hpp"

namespace corda::study {
namespace {

/// The accuracies that are compared.
constexpr std::array<double, 6> kAccuracies{1e-3, 1e-4, 1e-6, 1e-8, 1e-9, 1e-12};

/// The runs on a problem and their results.
struct Sweep {
    Subject subject;
    std::vector<Measurement> results;

    [[nodiscard]] const Problem& problem() const { return subject.problem; }
};

report::Table runs_table(const Sweep& sweep) {
    report::Table table{"speed_" + sweep.problem().id, "All runs: " + sweep.problem().title, {}, {}, {}};
    table.columns = {{"series", "method"},
                     {"parameter", "step [s] or tolerance"},
                     {"error_largest_over_length", "largest error / L"},
                     {"error_rms_over_length", "RMS error / L"},
                     {"strain_largest", "largest strain"},
                     {"energy_error_over_mgl", "energy error / (m g L)"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     {"ms_least", "least"},
                     {"ms_largest", "largest"},
                     {"steps", "steps"},
                     report::failure_column()};
    for (const Measurement& run : sweep.results) {
        if (!run.failure.empty()) {
            table.add_failed({run.label, run.parameter}, run.failure);
            continue;
        }
        table.add({run.label, run.parameter, report::cell_of(run.largest_error),
                   report::cell_of(run.rms_error), run.largest_strain, report::cell_of(run.energy_error),
                   run.ms_per_simulated_s.median(), run.ms_per_simulated_s.least(),
                   run.ms_per_simulated_s.largest(), static_cast<double>(run.steps)});
    }
    table.note =
        "Errors are the largest over all frames: of the distance of one particle from the truth, and of the "
        "root mean square of the distances of all particles.";
    return table;
}

/// In the order of the sweep.
std::vector<std::string> labels_of(const Sweep& sweep) {
    std::vector<std::string> labels;
    for (const Measurement& run : sweep.results) {
        if (labels.empty() || labels.back() != run.label) labels.push_back(run.label);
    }
    return labels;
}

report::Table fastest_table(const Sweep& sweep) {
    report::Table table;
    table.id = "fastest_" + sweep.problem().id;
    table.title = "Fastest at each accuracy: " + sweep.problem().title;
    table.columns = {{"error_goal", "RMS error / L at most"},
                     {"series", "method"},
                     {"parameter", "step [s] or tolerance"},
                     {"error_rms_over_length", "RMS error / L"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     {"ms_least", "least"},
                     {"ms_largest", "largest"}};
    for (const double error : kAccuracies) {
        std::vector<report::Cell> row{error, "none", {}, {}, {}, {}, {}};
        if (const Measurement* const best = cheapest_within(sweep.results, error)) {
            const report::Times& ms = best->ms_per_simulated_s;
            row = {error,       best->label, best->parameter, best->rms_error,
                   ms.median(), ms.least(),  ms.largest()};
        }
        table.add(std::move(row));
    }
    return table;
}

/// The colour and marker of a series in all plots; std::nullopt if it is context.
std::optional<std::size_t> look_of(const std::string& label) {
    constexpr std::array<std::pair<const char*, std::size_t>, 6> kLooks{
        {{"exact", 0},
         {"rattle, order 2", 4},
         {"rattle, order 4", 1},
         {"rattle, order 6", 3},
         {"rattle, order 8", 6},
         {"relaxation, reach 1, sweeps 1", 2}}};
    for (const auto& [name, look] : kLooks) {
        if (label == name) return look;
    }
    return std::nullopt;
}

report::Plot plot_of(const Sweep& sweep) {
    report::Plot plot;
    plot.id = "speed_" + sweep.problem().id;
    plot.title = sweep.problem().title;
    plot.x_title = "RMS error / L";
    plot.y_title = "ms per simulated second";
    plot.caption =
        plot.title +
        ". Each point is one run: the RMS position error over the length L, and the time per "
        "simulated second on one thread. Lower left is better. Bars span the fastest and the slowest "
        "repeat.";
    plot.context_name = "relaxation, other reaches and sweeps";
    for (const std::string& label : labels_of(sweep)) {
        report::Series series{.name = label, .points = {}, .look = look_of(label)};
        series.is_context = !series.look;
        for (const Measurement& run : sweep.results) {
            // An error of 0 has no place on a logarithmic axis.
            if (run.label == label && run.failure.empty() && run.rms_error > 0.0)
                series.add(run.rms_error, run.ms_per_simulated_s.median(),
                           {run.ms_per_simulated_s.least(), run.ms_per_simulated_s.largest()});
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string truth_paragraph(const Sweep& sweep) {
    const Subject& subject = sweep.subject;
    std::string text = fmt::format("{}. The truth is {}.", sweep.problem().title, sweep.problem().truth);
    if (subject.exact_reference) {
        text +=
            fmt::format(" Method exact itself is compared with {}. The two differ by {:.1e} L at most (RMS).",
                        subject.exact_truth, subject.disagreement.value_or(0.0));
    }
    if (subject.horizon_s) {
        text += fmt::format(
            " The motion is chaotic: after {:.3g} s two tight runs differ by more than {:.0e} L, and later "
            "frames are not compared.",
            *subject.horizon_s, kHorizonDifference);
    }
    return text;
}

std::vector<Problem> problems_of(const StudyDef& def) {
    if (def.scene) return {problem_of(*def.scene)};
    return {report_swing(), a01_pendulum(), released_chain(), spinning_chain()};
}

void add_jobs(const std::shared_ptr<Sweep>& sweep, bool is_quick, std::vector<Job>& jobs) {
    jobs.push_back({sweep->problem().id + ": truth", [sweep] {
                        if (!sweep->problem().reference) find_truth(sweep->subject);
                    }});
    for (const SweepRun& run : sweep_runs(sweep->problem(), is_quick)) {
        jobs.push_back({fmt::format("{}: {}, {:.3g}", sweep->problem().id, run.label, run.parameter),
                        [sweep, run, timing = study_timing(is_quick)] {
                            const Problem problem = with_reach(facing(sweep->subject, run.method), run.reach);
                            sweep->results.push_back(
                                measure(problem, run.method, run.label, run.parameter, timing));
                        }});
    }
}

void add_sweep(const Sweep& sweep, report::Chapter& chapter) {
    chapter.paragraphs.push_back(truth_paragraph(sweep));
    chapter.tables.push_back(fastest_table(sweep));
    chapter.tables.push_back(runs_table(sweep));
    chapter.plots.push_back(plot_of(sweep));
}

constexpr int kMaxHalvings = 8;

/// Updates of bars or particles in a run; one of more is left out.
double most_updates(bool is_quick) {
    return is_quick ? 4e5 : 1e7;
}

double updates_of(const System& system, double duration_s, const MethodDef& method, double step_s) {
    const auto* const relaxation = std::get_if<RelaxationDef>(&method);
    const auto* const rattle = std::get_if<RattleDef>(&method);
    const std::size_t per_step =
        relaxation != nullptr ? system.bars.size() * static_cast<std::size_t>(relaxation->sweeps)
                              : system.particle_count() * sim::composition(rattle->order).stages.size();
    return static_cast<double>(per_step) * duration_s / step_s;
}

void add_relaxation(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    constexpr double kMaxStepSeconds = 1.0 / 60.0;
    const double frame_s = problem.fps.interval_s();
    const double longest_step_s = frame_s / std::ceil(frame_s / kMaxStepSeconds - 1e-9);
    const std::size_t bars = problem.system().bars.size();
    for (const int reach : {1, 7}) {
        const Problem reaching = with_reach(problem, reach);
        const System system = reaching.system();
        const bool has_imaginary_bars = system.bars.size() > bars;
        if (reach > 1 && !has_imaginary_bars) continue;
        const bool is_refused = !refusal(reaching, RelaxationDef{longest_step_s}).empty();
        for (const int sweeps : {1, 4, 16, 64}) {
            const std::string label = fmt::format("relaxation, reach {}, sweeps {}", reach, sweeps);
            for (int halving = 0; halving <= kMaxHalvings; halving += is_quick ? 2 : 1) {
                const double step_s = std::ldexp(longest_step_s, -halving);
                const MethodDef method = RelaxationDef{step_s, sweeps};
                const double updates = updates_of(system, problem.world.duration_s, method, step_s);
                if (halving > 0 && (is_refused || updates > most_updates(is_quick))) break;
                runs.push_back({method, label, step_s, reach});
            }
        }
    }
}

void add_rattle(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, RattleDef{2}).empty();
    const System system = problem.system();
    const double frame_s = problem.fps.interval_s();
    for (const int order : {2, 4, 6, 8}) {
        const std::string label = fmt::format("rattle, order {}", order);
        if (is_refused) {
            runs.push_back({RattleDef{order}, label, frame_s});
            continue;
        }
        const double steps_per_frame = std::round(frame_s / rattle_step_s(problem, order));
        // High orders reach rounding after a few halvings: they take two points per halving.
        const bool is_high = order >= 6;
        const int points_per_halving = is_high && !is_quick ? 2 : 1;
        const int last_point = points_per_halving * (is_high ? 2 : kMaxHalvings);
        for (int point = 0; point <= last_point; ++point) {
            const double finer = std::exp2(static_cast<double>(point) / points_per_halving);
            const double step_s = frame_s / std::round(steps_per_frame * finer);
            const MethodDef method = RattleDef{order, step_s};
            const double updates = updates_of(system, problem.world.duration_s, method, step_s);
            if (point > 0 && updates > most_updates(is_quick)) break;
            runs.push_back({method, label, step_s});
        }
    }
}

void add_exact(const Problem& problem, bool is_quick, std::vector<SweepRun>& runs) {
    const bool is_refused = !refusal(problem, ExactDef{}).empty();
    for (int digits = 2; digits <= 13; digits += is_quick ? 2 : 1) {
        const double tolerance = std::stod(fmt::format("1e-{}", digits));
        runs.push_back({ExactDef{tolerance}, "exact", tolerance});
        if (is_refused) break;
    }
}

}  // namespace

const Measurement* cheapest_within(std::span<const Measurement> runs, double error) {
    const Measurement* best = nullptr;
    for (const Measurement& run : runs) {
        if (!run.failure.empty() || !(run.rms_error <= error)) continue;
        if (best == nullptr || run.ms_per_simulated_s.median() < best->ms_per_simulated_s.median())
            best = &run;
    }
    return best;
}

ChapterWork speed_work(const StudyDef& def) {
    ChapterWork work;
    std::vector<std::shared_ptr<Sweep>> sweeps;
    for (Problem& problem : problems_of(def)) {
        auto sweep = std::make_shared<Sweep>();
        sweep->subject.problem = std::move(problem);
        add_jobs(sweep, def.quick, work.jobs);
        sweeps.push_back(std::move(sweep));
    }
    work.finish = [sweeps] {
        report::Chapter chapter{.title = "Speed against error"};
        chapter.paragraphs = {
            "Every run computes the positions of all particles at every frame. Its time is that of the "
            "stepping alone, without set-up: the median of its repeats, with the least and the largest. A "
            "method is compared with another method if another one can run the problem."};
        for (const auto& sweep : sweeps) add_sweep(*sweep, chapter);
        return chapter;
    };
    return work;
}

std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick) {
    std::vector<SweepRun> runs;
    add_relaxation(problem, is_quick, runs);
    add_rattle(problem, is_quick, runs);
    add_exact(problem, is_quick, runs);
    return runs;
}

}  // namespace corda::study
