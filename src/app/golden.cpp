#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/suite/suite.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

using suite::Checked;
using suite::Verdict;

struct GoldenOptions {
    suite::SuiteDef def;
    GlOptions gl;
    std::string junit;
};

const char* word_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::kPassed:
            return "passed";
        case Verdict::kDifferent:
            return "different";
        case Verdict::kMissing:
            return "missing";
        case Verdict::kEmpty:
            return "empty";
        case Verdict::kStale:
            return "stale";
    }
    return "";
}

std::string line_of(const Checked& picture, const GoldenOptions& options) {
    if (picture.changed) {
        const char* const what = picture.verdict == Verdict::kStale ? "removed" : "written";
        return fmt::format("{}: {}{}", picture.name, options.def.dry_run ? "would be " : "", what);
    }
    std::string line = fmt::format("{}: {}", picture.name, word_of(picture.verdict));
    if (picture.verdict == Verdict::kMissing) return line + "; --update adds it";
    if (picture.verdict == Verdict::kStale) return line + ": no scene asks for it; --update removes it";
    if (picture.verdict == Verdict::kDifferent && picture.difference.same_size)
        line += fmt::format(": max {}, mean {:.6g}, share {:.6g}", picture.difference.max,
                            picture.difference.mean, picture.difference.share);
    return line + "; " + picture.cause;
}

nlohmann::json to_json(const Checked& picture) {
    nlohmann::json json{{"name", picture.name},
                        {"scene", picture.scene},
                        {"time_s", picture.time_s},
                        {"result", word_of(picture.verdict)},
                        {"cause", picture.cause},
                        {"compared_with", picture.variant},
                        {"changed", picture.changed},
                        {"max", nullptr},
                        {"mean", nullptr},
                        {"share", nullptr}};
    if (picture.variant.empty() || !picture.difference.same_size) return json;
    json["max"] = picture.difference.max;
    json["mean"] = picture.difference.mean;
    json["share"] = picture.difference.share;
    return json;
}

void write_junit(const std::string& path, const suite::SuiteResult& result) {
    OutputFile file(path, {.force = true});
    file.write(suite::junit_xml(result));
    file.commit();
}

ExitCode run_suite(const Console& console, GoldenOptions options) {
    if (options.def.dry_run && !options.def.update)
        throw Error(ExitCode::kUsage, "--dry-run shows what --update would change; give both");
    if (!options.junit.empty()) check_output(options.junit, "", true);
    options.gl.apply_to(options.def.film);
    leave_cores_to_chunks({});
    options.def.film.on_progress = stopping_if_asked(kSomethingWritten);
    options.def.on_progress = stopping_if_asked(kSomethingWritten);
    const suite::SuiteResult result = suite::run(options.def);
    if (!options.junit.empty()) write_junit(options.junit, result);
    nlohmann::json pictures = nlohmann::json::array();
    std::int64_t changed = 0;
    for (const Checked& picture : result.pictures) {
        if (picture.verdict != Verdict::kPassed || picture.changed) console.result(line_of(picture, options));
        changed += picture.changed ? 1 : 0;
        pictures.push_back(to_json(picture));
    }
    for (const std::string& frozen : result.frozen) console.detail(frozen);
    const std::int64_t passed = result.count(Verdict::kPassed);
    const std::int64_t failed = result.count(Verdict::kDifferent) + result.count(Verdict::kEmpty);
    const std::int64_t missing = result.count(Verdict::kMissing);
    const std::int64_t stale = options.def.update ? 0 : result.count(Verdict::kStale);
    console.result(fmt::format("{}: {} failed, {} missing, {} stale", counted(passed, "picture") + " passed",
                               failed, missing, stale));
    console.report({{"schema", 1},
                    {"passed", passed},
                    {"failed", failed},
                    {"missing", missing},
                    {"stale", stale},
                    {"changed", changed},
                    {"frozen", result.frozen},
                    {"pictures", pictures}});
    return failed + missing + stale == 0 ? ExitCode::kOk : ExitCode::kMismatch;
}

}  // namespace

void add_golden(CLI::App& app, Action& action) {
    auto options = std::make_shared<GoldenOptions>();
    CLI::App* command = app.add_subcommand(
        "golden", "draw the scenes that have a table [golden] and compare them with kept pictures");
    command->add_option("SCENE", options->def.paths, "scene files, or folders of them")->required();
    command->add_option("--dir", options->def.folder, "folder of the kept pictures")->required();
    command->add_flag("--update", options->def.update,
                      "write pictures that are missing or differ, and remove stale ones");
    command->add_flag("--dry-run", options->def.dry_run, "with --update: only say what would change");
    command->add_option("--junit", options->junit, "also write the results as JUnit XML to this file");
    command->add_option("--set", options->def.settings, "key=value in place of what the scenes say")
        ->type_name("KEY=VALUE");
    options->gl.add_to(*command);
    command->callback([options, &action] {
        action = [options](const Console& console) { return run_suite(console, *options); };
    });
}

}  // namespace corda::app
