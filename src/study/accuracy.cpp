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

report::Table rows_table(const std::vector<AccuracyRow>& rows) {
    report::Table table{"reference_numbers", "Every reference number", {}, {}, {}};
    table.columns = {{"reference", "reference"},
                     {"case", "case"},
                     {"quantity", "compared"},
                     {"method", "method"},
                     {"error", "error"},
                     {"bound_claimed", "bound that auto claims"},
                     {"wall_ms", "wall time [ms]"},
                     {"ms_per_simulated_s", "ms per simulated second"},
                     report::failure_column()};
    for (const AccuracyRow& row : rows) {
        std::vector<report::Cell> cells{row.reference, row.title, row.quantity, row.method};
        if (!row.failure.empty()) {
            table.add_failed(std::move(cells), row.failure);
            continue;
        }
        cells.insert(cells.end(),
                     {row.error, report::cell_of(row.bound), row.wall_ms, row.ms_per_simulated_s});
        table.add(std::move(cells));
    }
    return table;
}

/// The largest error and time of each reference, quantity and method, in the order of `rows`.
std::vector<AccuracyRow> worst_rows(const std::vector<AccuracyRow>& rows) {
    std::vector<AccuracyRow> worst;
    for (const AccuracyRow& row : rows) {
        const auto same = std::find_if(worst.begin(), worst.end(), [&](const AccuracyRow& other) {
            return other.reference == row.reference && other.quantity == row.quantity &&
                   other.method == row.method;
        });
        if (same == worst.end()) {
            worst.push_back(row);
            continue;
        }
        same->error = std::max(same->error, row.error);
        same->ms_per_simulated_s = std::max(same->ms_per_simulated_s, row.ms_per_simulated_s);
        if (same->failure.empty()) same->failure = row.failure;
    }
    return worst;
}

report::Table short_table(const std::vector<AccuracyCase>& cases, const std::vector<AccuracyRow>& rows) {
    report::Table table{"accuracy", "Accuracy against published numbers", {}, {}, {}};
    table.columns = {{"case", "case"},
                     {"method", "method"},
                     {"error", "largest error"},
                     {"ms_per_simulated_s", "ms per simulated second, at most"},
                     report::failure_column()};
    for (const AccuracyRow& row : worst_rows(rows)) {
        const auto source = std::find_if(cases.begin(), cases.end(), [&](const AccuracyCase& one) {
            return one.reference == row.reference;
        });
        const std::string name = fmt::format("{} {} ({})", row.reference, source->title, row.quantity);
        if (row.failure.empty()) {
            table.add({name, row.method, row.error, row.ms_per_simulated_s});
        } else {
            table.add_failed({name, row.method}, row.failure);
        }
    }
    table.note = "None of these numbers was computed by Corda. The next table has every one of them.";
    return table;
}

std::string bounds_paragraph(const std::vector<AccuracyRow>& rows) {
    constexpr double kReferenceError = 1e-13;
    int claims = 0;
    int true_ones = 0;
    for (const AccuracyRow& row : rows) {
        if (!row.bound || !row.failure.empty()) continue;
        ++claims;
        if (row.error <= *row.bound + kReferenceError) ++true_ones;
    }
    return fmt::format("Method auto claims a bound of its error in {} rows; {} of these bounds hold.", claims,
                       true_ones);
}

void add_problem_row(AccuracyRow row, const Problem& problem, const NamedMethod& method, const Timing& timing,
                     std::vector<AccuracyRow>& rows) {
    const Measurement run = measure(problem, method.method, method.name, 0.0, timing);
    row.method = method.name;
    row.error = run.largest_error;
    row.failure = run.failure;
    row.ms_per_simulated_s = run.ms_per_simulated_s.median();
    row.wall_ms = row.ms_per_simulated_s * problem.fps.time_s(problem.last_frame());
    rows.push_back(std::move(row));
}

void add_auto_row(const AccuracyRow& named, const Problem& problem, const Timing& timing,
                  std::vector<AccuracyRow>& rows) {
    constexpr double kTolerance = 1e-6;  // of the length
    const System system = problem.system();
    sim::Recording unread(system.particle_count(), 1, 0);
    const auto tolerance_m = [&](const MotionBounds&) { return kTolerance * problem.length_m; };
    const Timeline timeline(problem.fps, problem.last_frame());
    const OnProgress on_frame = [](std::int64_t, std::int64_t) {
        check_cancelled();
        return true;
    };
    const BodyPlan plan =
        sim::plan_body(system, problem.world, {tolerance_m, timeline, on_frame, {}}, unread);
    add_problem_row(named, problem, {"auto", plan.method}, timing, rows);
    AccuracyRow& row = rows.back();
    row.title += fmt::format(" (auto chose {})", method_name(plan.method));
    if (plan.horizon_s) {
        row.failure = fmt::format("auto claims no bound after {:.3g} s", *plan.horizon_s);
    } else if (plan.error_bound_m) {
        row.bound = *plan.error_bound_m / problem.length_m;
    }
}

}  // namespace

void add_probe_rows(const AccuracyRow& named, const RopeDef& rope, const WorldDef& world,
                    std::span<const NamedMethod> methods, double simulated_s,
                    const std::function<double(Probe&)>& error_of, std::vector<AccuracyRow>& rows) {
    for (const NamedMethod& method : methods) {
        AccuracyRow& row = rows.emplace_back(named);
        row.method = method.name;
        try {
            Probe probe(rope, world, method.method);
            row.error = error_of(probe);
            row.wall_ms = 1e3 * probe.wall_s();
            row.ms_per_simulated_s = row.wall_ms / simulated_s;
        } catch (const Error& error) {
            row.failure = error.what();
        }
    }
}

void add_problem_rows(const AccuracyRow& named, const Problem& problem, std::span<const NamedMethod> methods,
                      const Timing& timing, std::vector<AccuracyRow>& rows) {
    add_auto_row(named, problem, timing, rows);
    for (const NamedMethod& method : methods) add_problem_row(named, problem, method, timing, rows);
}

ChapterWork accuracy_work(const StudyDef& def) {
    auto cases = pendulum_cases();
    for (const auto& more : {chain_cases(), material_cases()})
        cases.insert(cases.end(), more.begin(), more.end());
    const auto rows = std::make_shared<std::vector<AccuracyRow>>();
    ChapterWork work;
    for (const AccuracyCase& source : cases) {
        work.jobs.push_back({source.reference + ": " + source.title,
                             [source, rows, is_quick = def.quick] { source.run(is_quick, *rows); }});
    }
    work.finish = [cases, rows] {
        report::Chapter chapter;
        chapter.title = "Reference numbers";
        chapter.paragraphs = {
            "The methods against closed forms and against numbers that were computed by others to more "
            "digits than a double holds.",
            bounds_paragraph(*rows)};
        chapter.tables = {short_table(cases, *rows), rows_table(*rows)};
        chapter.summary = bounds_paragraph(*rows);
        return chapter;
    };
    return work;
}

}  // namespace corda::study
