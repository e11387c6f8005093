#include "benchmark/study/accuracy.hpp"

#include <utility>

#include <fmt/format.h>

#include "benchmark/study/chapters.hpp"
#include "benchmark/study/measure.hpp"
#include "corda/core/basics.hpp"
#include "corda/sim/auto/planner.hpp"

namespace corda::study {
namespace {

nlohmann::json row_json(const AccuracyCase& given, const AccuracyRow& row) {
    nlohmann::json result{{"reference", given.reference},
                          {"subject", given.subject},
                          {"case", row.title},
                          {"quantity", given.quantity},
                          {"method", row.method}};
    if (!row.failure.empty()) {
        result["failure"] = row.failure;
        return result;
    }
    result["error"] = row.error;
    result["bound"] = json_of(row.bound);
    result["wall_ms"] = row.wall_ms;
    result["ms_per_simulated_s"] = row.ms_per_simulated_s;
    return result;
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
    sim::Recording unread(system.particle_count(), 1);
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

nlohmann::json measure_accuracy(const Options& options, const OnRun& on_run) {
    nlohmann::json rows = nlohmann::json::array();
    for (const AccuracyCase& given : accuracy_cases()) {
        if (options.quick && given.is_slow) continue;
        on_run(given.reference + ": " + given.title);
        for (const AccuracyRow& row : run_accuracy_case(given, options.timing()))
            rows.push_back(row_json(given, row));
    }
    return {{"rows", std::move(rows)}};
}

}  // namespace corda::study
