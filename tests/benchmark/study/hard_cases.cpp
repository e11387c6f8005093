#include "benchmark/study/hard_cases.hpp"

#include <limits>
#include <utility>

#include <fmt/format.h>

#include "benchmark/study/chapters.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/scene/scene.hpp"

namespace corda::study {
namespace {

/// "passed" is null for a case that is not run.
nlohmann::json case_json(const HardCase& hard, bool is_quick) {
    nlohmann::json result{{"case", hard.name},
                          {"method", hard.method},
                          {"criterion", hard.criterion},
                          {"measured", "too slow for a quick study"},
                          {"passed", nullptr}};
    if (hard.kind != HardCase::Kind::kQuick && is_quick) return result;
    const double from_s = now_s();
    const Outcome outcome = run_hard_case(hard);
    result["measured"] = outcome.measured;
    result["passed"] = outcome.passed;
    result["wall_s"] = now_s() - from_s;
    return result;
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
                     fmt::format("strain < {:g}, energy error < {:g}", limits.strain, limits.energy_error),
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

nlohmann::json measure_hard_cases(const Options& options, const OnRun& on_run) {
    nlohmann::json rows = nlohmann::json::array();
    for (const HardCase& hard : hard_cases()) {
        on_run(hard.name + ", " + hard.method);
        rows.push_back(case_json(hard, options.quick));
    }
    return {{"times", "of one run"}, {"cases", std::move(rows)}};
}

}  // namespace corda::study
