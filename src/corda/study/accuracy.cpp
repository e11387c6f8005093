#include "corda/study/accuracy.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {
namespace {

/// A case and its outcomes.
struct Measured {
    AccuracyCase given;
    std::vector<AccuracyRow> rows;
};

report::Table rows_table(const std::vector<Measured>& cases) {
    report::Table table{"reference_numbers", "Every reference number", {}, {}, {}};
    table.columns = {{"reference", "reference"},
                     {"case", "case"},
                     {"quantity", "compared"},
                     {"method", "method"},
                     {"error", "error"},
                     {"bound", "bound"},
                     {"wall_ms", "wall time [ms]"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     report::failure_column()};
    for (const auto& [given, rows] : cases) {
        for (const AccuracyRow& row : rows) {
            std::vector<report::Cell> cells{given.reference, row.title, given.quantity, row.method};
            if (!row.failure.empty()) {
                table.add_failed(std::move(cells), row.failure);
                continue;
            }
            cells.insert(cells.end(),
                         {row.error, report::cell_of(row.bound), row.wall_ms, row.ms_per_simulated_s});
            table.add(std::move(cells));
        }
    }
    table.note =
        "Of method auto, its error estimate for this run; of the others, the bound in tests/accuracy.";
    return table;
}

/// The largest error and time of each reference, quantity and method.
report::Table short_table(const std::vector<Measured>& cases) {
    report::Table table{"accuracy", "Accuracy against published numbers", {}, {}, {}};
    table.columns = {{"case", "case"},
                     {"method", "method"},
                     {"error", "largest error"},
                     {"ms_per_simulated_s", "ms per simulated second, at most"},
                     report::failure_column()};
    const auto keep_largest = [](report::Cell& cell, double value) {
        if (auto* largest = std::get_if<double>(&cell)) *largest = std::max(*largest, value);
    };
    for (const auto& [given, rows] : cases) {
        const report::Cell name = fmt::format("{} {} ({})", given.reference, given.subject, given.quantity);
        for (const AccuracyRow& row : rows) {
            const auto same = std::ranges::find_if(table.rows, [&](const auto& cells) {
                return cells[0] == name && cells[1] == report::Cell(row.method);
            });
            if (!row.failure.empty()) {
                table.add_failed({name, row.method}, row.failure);
            } else if (same == table.rows.end()) {
                table.add({name, row.method, row.error, row.ms_per_simulated_s});
            } else {
                keep_largest((*same)[2], row.error);
                keep_largest((*same)[3], row.ms_per_simulated_s);
            }
        }
    }
    table.note = "None of these numbers was computed by Corda. The next table has every one of them.";
    return table;
}

AccuracyRow compare_with_reference(const AccuracyCase& given, const AccuracyMethod& method,
                                   const Timing& timing) {
    const Measurement run = measure(given.problem, method.method, method.name, 0.0, timing);
    const double ms_per_simulated_s = run.ms_per_simulated_s.median();
    return {given.title,
            method.name,
            run.largest_error,
            method.bound,
            ms_per_simulated_s * given.problem.world.duration_s,
            ms_per_simulated_s,
            run.failure};
}

AccuracyRow run_method(const AccuracyCase& given, const AccuracyMethod& method, const Timing& timing) {
    if (!given.error_of) return compare_with_reference(given, method, timing);
    AccuracyRow row{given.title, method.name, 0.0, method.bound, 0.0, 0.0, {}};
    try {
        Probe probe(given.problem.ropes.front(), given.problem.world, method.method);
        row.error = given.error_of(probe);
        row.wall_ms = 1e3 * probe.wall_s();
        row.ms_per_simulated_s = row.wall_ms / given.problem.world.duration_s;
    } catch (const Error& error) {
        row.failure = error.what();
    }
    return row;
}

AccuracyRow run_auto(const AccuracyCase& given, const Timing& timing) {
    constexpr double kTolerance = 1e-6;  // of the length
    constexpr double kReferenceError = 1e-13;
    const Problem& problem = given.problem;
    const System system = problem.system();
    sim::Recording unread(system.particle_count(), 1, 0);
    const auto tolerance_m = [&](const MotionBounds&) { return kTolerance * problem.length_m; };
    const Timeline timeline(problem.fps, problem.last_frame());
    const BodyPlan plan = sim::plan_body(system, problem.world, {tolerance_m, timeline, {}, {}}, unread);
    AccuracyRow row = compare_with_reference(given, {"auto", plan.method}, timing);
    row.title += fmt::format(" (auto chose {})", method_name(plan.method));
    row.bound = plan.error_estimate_m.value_or(0.0) / problem.length_m + kReferenceError;
    if (plan.horizon_s) row.failure = fmt::format("auto estimates no error after {:.3g} s", *plan.horizon_s);
    return row;
}

}  // namespace

std::vector<AccuracyCase> accuracy_cases() {
    std::vector<AccuracyCase> cases;
    add_pendulum_cases(cases);
    add_chain_cases(cases);
    add_material_cases(cases);
    return cases;
}

std::vector<AccuracyRow> run_accuracy_case(const AccuracyCase& given, const Timing& timing) {
    std::vector<AccuracyRow> rows;
    if (!given.error_of) rows.push_back(run_auto(given, timing));
    for (const AccuracyMethod& method : given.methods) rows.push_back(run_method(given, method, timing));
    return rows;
}

ChapterWork accuracy_work(const StudyDef& def) {
    const auto measured = std::make_shared<std::vector<Measured>>();
    ChapterWork work;
    for (const AccuracyCase& given : accuracy_cases()) {
        if (def.quick && given.is_slow) continue;
        work.jobs.push_back(
            {given.reference + ": " + given.title, [given, measured, timing = study_timing(def.quick)] {
                 measured->push_back({given, run_accuracy_case(given, timing)});
             }});
    }
    work.finish = [measured] {
        report::Chapter chapter{.title = "Reference numbers"};
        chapter.paragraphs = {
            "The methods against closed forms and against numbers that were computed by others to more "
            "digits than a double holds."};
        chapter.tables = {short_table(*measured), rows_table(*measured)};
        return chapter;
    };
    return work;
}

}  // namespace corda::study
