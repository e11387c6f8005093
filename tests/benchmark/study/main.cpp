// Measures a chapter of tests/benchmark/README.md and prints its numbers as JSON. study.py runs it.

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmark/study/chapters.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"

namespace corda::study {
namespace {

struct Chapter {
    std::string_view name;
    nlohmann::json (*measure)(const Options& options, const OnRun& on_run);
    bool takes_a_scene;
};
constexpr std::array<Chapter, 6> kChapters{{{"speed", measure_speed, true},
                                            {"findings", measure_findings, false},
                                            {"accuracy", measure_accuracy, false},
                                            {"hard_cases", measure_hard_cases, false},
                                            {"challenge", measure_challenge, false},
                                            {"horizons", measure_horizons, false}}};

const Chapter& find_chapter(const std::string& name) {
    std::string known;
    for (const Chapter& chapter : kChapters) {
        if (chapter.name == name) return chapter;
        known += (known.empty() ? "" : ", ") + std::string(chapter.name);
    }
    throw Error(ExitCode::kUsage,
                fmt::format("there is no chapter \"{}\"; known are {}", printable(name), known));
}

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#elif defined(__GNUC__)
    return "GCC " __VERSION__;
#else
    return "unknown";
#endif
}

/// How times are taken, unless a chapter says otherwise.
std::string times_of(const Timing& timing) {
    return fmt::format("on one thread, by CLOCK_MONOTONIC: the median of {} repeats of at least {:g} ms",
                       timing.repeats, 1e3 * timing.shortest_s);
}

/// Names the measurement in hand on standard error, every two seconds at most.
OnRun show_progress(const std::string& chapter) {
    return [chapter, last_s = 0.0](const std::string& what) mutable {
        if (now_s() - last_s < 2.0) return;
        last_s = now_s();
        fmt::print(stderr, "{}: {}\n", chapter, printable(what));
    };
}

int run(int argc, char** argv) {
    Options options;
    std::string name;
    std::string path;
    std::vector<Setting> settings;
    CLI::App app("Measures a chapter of the study and prints its numbers as JSON", "benchmark_study");
    app.add_option("CHAPTER", name, "speed, findings, accuracy, hard_cases, challenge or horizons")
        ->required();
    app.add_flag("--quick", options.quick, "fewer and shorter runs, not to quote from");
    app.add_option("--scene", path, "scene file that chapter speed measures in place of its own problems");
    app.add_option("--set", settings, "override a key of the scene")->expected(1)->take_all();
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        throw Error(ExitCode::kUsage, error.what());
    }
    const Chapter& chapter = find_chapter(name);
    if (!path.empty() && !chapter.takes_a_scene) {
        throw Error(ExitCode::kUsage, fmt::format("chapter \"{}\" is about built-in problems; leave out "
                                                  "the scene or the chapter",
                                                  name));
    }
    if (path.empty() && !settings.empty())
        throw Error(ExitCode::kUsage, "--set changes a scene; name its file with --scene");
    if (!path.empty()) options.scene = load_scene(path, settings);
    nlohmann::json result = chapter.measure(options, show_progress(name));
    result["schema"] = 1;
    result["chapter"] = name;
    result["quick"] = options.quick;
    result["compiler"] = compiler();
    result["build"] = CORDA_BUILD_TYPE ": " CORDA_BUILD_FLAGS;
    result["corda"] = version();
    if (!result.contains("times")) result["times"] = times_of(options.timing());
    // Names of scenes may be any bytes.
    fmt::print("{}\n", result.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    return 0;
}

}  // namespace
}  // namespace corda::study

int main(int argc, char** argv) {
    try {
        return corda::study::run(argc, argv);
    } catch (const corda::Error& error) {
        fmt::print(stderr, "benchmark_study: {}\n", error.what());
        return static_cast<int>(error.code());
    }
}
