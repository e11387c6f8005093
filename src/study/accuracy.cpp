#include "corda/study/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "corda/core/error.hpp"
#include "corda/sim/planner.hpp"

namespace corda::study {
namespace {

Table rows_table(const std::vector<AccuracyRow>& rows) {
    Table table{"reference_numbers", "Every reference number", {}, {}, {}};
    table.columns = {{"reference", "reference"},
                     {"case", "case"},
                     {"quantity", "compared"},
                     {"method", "method"},
                     {"error", "error"},
                     {"bound_claimed", "bound that auto claims"},
                     {"wall_ms", "wall time [ms]"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     {std::string(kFailureKey), "failed because"}};
    for (const AccuracyRow& row : rows) {
        const bool failed = !row.failure.empty();
        table.rows.push_back({row.reference, row.title, row.quantity, row.method,
                              failed ? Cell() : Cell(row.error), cell_of(row.bound),
                              failed ? Cell() : Cell(row.wall_ms), cell_of(row.ms_per_simulated_s),
                              failed ? Cell(row.failure) : Cell()});
    }
    return table;
}

/// The largest error of each reference, method and quantity.
Table short_table(const std::vector<AccuracyCase>& cases, const std::vector<AccuracyRow>& rows) {
    Table table{"accuracy", "Accuracy against published numbers", {}, {}, {}};
    table.columns = {{"case", "case"},
                     {"method", "method"},
                     {"error", "largest error"},
                     {"ms_per_simulated_s", "ms per simulated second, at most"},
                     {std::string(kFailureKey), "failed because"}};
    for (const AccuracyCase& source : cases) {
        std::vector<AccuracyRow> worst;
        for (const AccuracyRow& row : rows) {
            if (row.reference != source.reference) continue;
            const auto same = std::find_if(worst.begin(), worst.end(), [&](const AccuracyRow& other) {
                return other.method == row.method && other.quantity == row.quantity;
            });
            if (same == worst.end()) {
                worst.push_back(row);
                continue;
            }
            same->error = std::max(same->error, row.error);
            if (row.ms_per_simulated_s)
                same->ms_per_simulated_s =
                    std::max(same->ms_per_simulated_s.value_or(0.0), *row.ms_per_simulated_s);
            if (same->failure.empty()) same->failure = row.failure;
        }
        for (const AccuracyRow& row : worst) {
            const std::string name = fmt::format("{} {} ({})", source.reference, source.title, row.quantity);
            const bool failed = !row.failure.empty();
            table.rows.push_back({name, row.method, failed ? Cell() : Cell(row.error),
                                  failed ? Cell() : cell_of(row.ms_per_simulated_s),
                                  failed ? Cell(row.failure) : Cell()});
        }
    }
    table.note = "Reference numbers are from outside of Corda; see the table of every one of them.";
    return table;
}

std::string bounds_paragraph(const std::vector<AccuracyRow>& rows) {
    int claims = 0;
    int true_ones = 0;
    for (const AccuracyRow& row : rows) {
        if (!row.bound || !row.failure.empty()) continue;
        ++claims;
        // References have an end, too: 1e-13 of the length.
        if (row.error <= *row.bound + 1e-13) ++true_ones;
    }
    return fmt::format("Method auto claims a bound of its error in {} of the rows; {} of these bounds hold.",
                       claims, true_ones);
}

void add_problem_row(const AccuracyRow& named, const Problem& problem, const NamedMethod& method,
                     const Timing& timing, std::vector<AccuracyRow>& rows) {
    AccuracyRow row = named;
    row.method = method.name;
    const Measurement run = measure(problem, method.solver, method.name, 0.0, timing);
    row.error = run.largest_error;
    row.failure = run.failure;
    row.ms_per_simulated_s = run.ms_per_simulated_s;
    row.wall_ms = run.ms_per_simulated_s * static_cast<double>(problem.last_frame) * problem.frame_interval_s;
    rows.push_back(std::move(row));
}

void add_auto_row(const AccuracyRow& named, const Problem& problem, const Timing& timing,
                  std::vector<AccuracyRow>& rows) {
    constexpr double kTolerance = 1e-6;  // of the length
    const sim::System system = sim::build_system(problem.ropes, problem.nets, 1);
    const FrameRate frames(Rational{std::lround(1.0 / problem.frame_interval_s), 1});
    const sim::Plan plan =
        sim::plan_solver(system, problem.world, {kTolerance * problem.length_m, frames, problem.last_frame});
    add_problem_row(named, problem, {"auto", plan.solver}, timing, rows);
    AccuracyRow& row = rows.back();
    row.title += fmt::format(" (auto took {})", sim::method_name(plan.solver.method));
    if (plan.horizon_s) {
        row.failure = fmt::format("auto claims nothing after {:.3g} s", *plan.horizon_s);
    } else if (plan.error_bound_m) {
        row.bound = *plan.error_bound_m / problem.length_m;
    }
}

}  // namespace

AccuracyRow named_row(std::string reference, std::string title, std::string quantity) {
    AccuracyRow row;
    row.reference = std::move(reference);
    row.title = std::move(title);
    row.quantity = std::move(quantity);
    return row;
}

void add_row(AccuracyRow row, const std::function<void(AccuracyRow&)>& figures,
             std::vector<AccuracyRow>& rows) {
    try {
        figures(row);
    } catch (const Error& error) {
        row.failure = error.what();
    }
    rows.push_back(std::move(row));
}

void add_probe_rows(const AccuracyRow& named, const sim::RopeDef& rope, const sim::WorldDef& world,
                    std::span<const NamedMethod> methods, double simulated_s,
                    const std::function<double(Probe&)>& error_of, std::vector<AccuracyRow>& rows) {
    for (const NamedMethod& method : methods) {
        AccuracyRow row = named;
        row.method = method.name;
        const auto figures = [&](AccuracyRow& filled) {
            Probe probe(rope, world, method.solver);
            filled.error = error_of(probe);
            filled.wall_ms = 1e3 * probe.wall_s();
            filled.ms_per_simulated_s = filled.wall_ms / simulated_s;
        };
        add_row(std::move(row), figures, rows);
    }
}

void add_problem_rows(const AccuracyRow& named, const Problem& problem, std::span<const NamedMethod> methods,
                      const Timing& timing, std::vector<AccuracyRow>& rows) {
    add_auto_row(named, problem, timing, rows);
    for (const NamedMethod& method : methods) add_problem_row(named, problem, method, timing, rows);
}

ChapterWork accuracy_work(const StudyDef& def) {
    struct Rows {
        std::vector<AccuracyCase> cases;
        std::vector<AccuracyRow> rows;
    };
    const auto shared = std::make_shared<Rows>();
    shared->cases = pendulum_cases();
    for (AccuracyCase& source : chain_cases()) shared->cases.push_back(std::move(source));
    for (AccuracyCase& source : material_cases()) shared->cases.push_back(std::move(source));
    ChapterWork work;
    const auto options = std::make_shared<StudyDef>();
    options->quick = def.quick;
    for (std::size_t k = 0; k < shared->cases.size(); ++k) {
        work.jobs.push_back({shared->cases[k].reference + ": " + shared->cases[k].title,
                             [shared, options, k] { shared->cases[k].run(*options, shared->rows); }});
    }
    work.finish = [shared] {
        Chapter chapter;
        chapter.title = "Reference numbers";
        chapter.paragraphs = {
            "Closed forms and numbers that others have worked out to more digits than a double holds, and "
            "what "
            "the methods make of them.",
            bounds_paragraph(shared->rows)};
        chapter.tables = {short_table(shared->cases, shared->rows), rows_table(shared->rows)};
        return chapter;
    };
    return work;
}

}  // namespace corda::study
