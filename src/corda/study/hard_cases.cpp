#include "corda/study/hard_cases.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/report/writers.hpp"
#include "corda/scene/scene.hpp"

namespace corda::study {
namespace {

constexpr const char* kPassed = "yes";
constexpr const char* kFailed = "no";
constexpr const char* kNotRun = "not run";

std::vector<report::Cell> row_of(const HardCase& hard, bool is_quick) {
    std::vector<report::Cell> row{hard.name, hard.method, hard.criterion};
    if (hard.kind != HardCase::Kind::kQuick && is_quick) {
        row.insert(row.end(), {"too slow for a quick study", kNotRun});
        return row;
    }
    const double from_s = now_s();
    const Outcome outcome = run_hard_case(hard);
    row.insert(row.end(), {outcome.measured, outcome.passed ? kPassed : kFailed, now_s() - from_s});
    return row;
}

report::Chapter chapter_of(const report::Table& table) {
    const auto count = [&](const char* result) {
        return std::ranges::count_if(table.rows,
                                     [&](const auto& row) { return row[4] == report::Cell(result); });
    };
    report::Chapter chapter{.title = "Hard cases"};
    chapter.summary = fmt::format("Of {} hard cases, {} passed, {} failed and {} were not run.",
                                  table.rows.size(), count(kPassed), count(kFailed), count(kNotRun));
    chapter.paragraphs = {chapter.summary};
    chapter.tables = {table};
    return chapter;
}

/// Passes if each of these scenes is refused as invalid.
Outcome refused(const std::vector<std::string>& scenes) {
    std::string message;
    for (const std::string& toml : scenes) {
        try {
            static_cast<void>(parse_scene("schema = 1\n" + toml, "scene.toml"));
            return {fmt::format("read without an error: {}", toml), false};
        } catch (const Error& error) {
            message = error.what();
            if (error.code() != ExitCode::kInvalidScene) return {message, false};
        }
    }
    return {fmt::format("refused, e.g. {}", message), true};
}

void add_hard_inputs(std::vector<HardCase>& cases) {
    const std::string rope = "[[rope]]\nline = { particles = 5, step = [0.1, -1.0] }\n";
    const std::string stepped = rope + "[solver]\nmethod = \"rattle\"\nstep = ";
    const auto add = [&](const char* name, const std::vector<std::string>& scenes) {
        cases.push_back(
            {name, "all", "refused", HardCase::Kind::kQuick, [scenes] { return refused(scenes); }});
    };
    add("mass 0 of a free particle", {rope + "mass = 0.0\n", rope + "mass = [1.0, 1.0, 0.0, 1.0, 1.0]\n"});
    add("step 0, negative, NaN", {stepped + "0.0\n", stepped + "-0.01\n", stepped + "nan\n"});
    add("coincident particles, rest length 0",
        {"[[rope]]\npoints = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]\n",
         "[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\nlink_length = 0.0\n"});
}

Outcome watch(const RopeDef& rope, const MethodDef& method, const Limits& limits) {
    Probe probe(rope, WorldDef{}, method);
    probe.go_by_frames(limits.duration_s, limits.frames_per_second);
    const Figures largest = probe.diagnostics().largest;
    const double energy_error = largest.energy_error.value_or(std::numeric_limits<double>::infinity());
    return {fmt::format("strain {:.1e}, energy error {:.1e}", largest.strain, energy_error),
            largest.strain < limits.strain && energy_error < limits.energy_error};
}

}  // namespace

void add_watched(const std::string& name, const char* method_name, const RopeDef& rope,
                 const MethodDef& method, const Limits& limits, HardCase::Kind kind,
                 std::vector<HardCase>& cases) {
    cases.push_back({name, method_name,
                     fmt::format("strain < {}, energy error < {}", report::short_number(limits.strain),
                                 report::short_number(limits.energy_error)),
                     kind, [=] { return watch(rope, method, limits); }});
}

std::vector<HardCase> hard_cases() {
    std::vector<HardCase> cases;
    add_hard_motions(cases);
    add_hard_sizes(cases);
    add_hard_inputs(cases);
    return cases;
}

Outcome run_hard_case(const HardCase& hard) {
    try {
        return hard.run();
    } catch (const Error& error) {
        return {error.what(), false};
    }
}

ChapterWork hard_cases_work(const StudyDef& def) {
    const auto table = std::make_shared<report::Table>();
    table->id = "hard_cases";
    table->title = "Hard cases";
    table->columns = {{"case", "case"},         {"method", "method"}, {"criterion", "passes if"},
                      {"measured", "measured"}, {"passed", "passed"}, {"wall_s", "wall time [s]"}};
    table->note = "An energy error is a fraction of the total weight times the length.";
    ChapterWork work;
    for (const HardCase& hard : hard_cases()) {
        work.jobs.push_back({hard.name + ", " + hard.method,
                             [table, hard, is_quick = def.quick] { table->add(row_of(hard, is_quick)); }});
    }
    work.finish = [table] { return chapter_of(*table); };
    return work;
}

}  // namespace corda::study
