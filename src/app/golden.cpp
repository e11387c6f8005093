#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/suite.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

using golden::Checked;
using golden::Verdict;

struct GoldenOptions {
    golden::SuiteDef def;
    GlOptions gl;
    std::string junit;
    std::string html;
};

/// A page of more pictures is too large to open.
constexpr int kMaxOnPage = 200;

/// In the order of Verdict.
constexpr std::array<const char*, 6> kWords{"passed", "different", "missing", "empty", "stale", "invalid"};

const char* word_of(Verdict verdict) {
    return kWords.at(static_cast<std::size_t>(verdict));
}

std::string line_of(const Checked& picture, const GoldenOptions& options) {
    std::string line = picture.name + ": ";
    if (picture.changed) {
        line += options.def.dry_run ? "would be " : "";
        line += picture.verdict == Verdict::kStale ? "removed: " : "written: ";
    }
    if (!picture.changed || picture.verdict != Verdict::kPassed) line += word_of(picture.verdict);
    if (picture.verdict == Verdict::kDifferent && picture.difference.same_size)
        line += ": " + figures_text(picture.difference);
    if (!picture.cause.empty()) line += (line.ends_with(' ') ? "" : "; ") + picture.cause;
    if (picture.failed() && picture.verdict == Verdict::kMissing) line += "; --update adds it";
    if (picture.failed() && picture.verdict == Verdict::kStale && !picture.has_no_record)
        line += "; --update removes it";
    return line;
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
    json["max"] = max_json(picture.difference);
    json["mean"] = picture.difference.mean;
    json["share"] = picture.difference.share;
    return json;
}

void write_text(const std::string& path, const std::string& text) {
    OutputFile file(path, {.force = true});
    file.write(text);
    file.commit();
}

/// Prints failures, changes and totals.
void tell(const Console& console, const GoldenOptions& options, const golden::SuiteResult& result) {
    nlohmann::json pictures = nlohmann::json::array();
    std::int64_t changed = 0;
    for (const Checked& picture : result.pictures) {
        if (picture.verdict == Verdict::kInvalid)
            console.error(picture.cause);
        else if (picture.failed() || picture.changed)
            console.result(line_of(picture, options));
        changed += picture.changed ? 1 : 0;
        pictures.push_back(to_json(picture));
    }
    for (const std::string& note : result.notes) console.warning(note);
    for (const std::string& detail : result.details) console.detail(detail);
    for (const std::string& frozen : result.frozen) console.detail(frozen);
    const std::int64_t passed = result.count(Verdict::kPassed);
    const std::int64_t failed = result.count(Verdict::kDifferent) + result.count(Verdict::kEmpty);
    const std::int64_t missing = result.count(Verdict::kMissing);
    const std::int64_t stale = result.count(Verdict::kStale);
    const std::int64_t invalid = result.count(Verdict::kInvalid);
    std::string sums = fmt::format("{}: {} failed, {} missing, {} stale",
                                   counted(passed, "picture") + " passed", failed, missing, stale);
    if (invalid > 0) sums += fmt::format("; {} invalid", counted(invalid, "scene"));
    if (options.def.update)
        sums += fmt::format("; {}{} written or removed", changed, options.def.dry_run ? " would be" : "");
    console.result(sums);
    std::error_code none;
    if (missing > 0 && !std::filesystem::exists(options.def.folder, none))
        console.warning(fmt::format("there is no folder '{}'; --update makes it", options.def.folder));
    else if (missing > 0)
        console.info("--update draws the missing pictures and keeps them");
    nlohmann::json json = {{"schema", 1},         {"passed", passed},        {"failed", failed},
                           {"missing", missing},  {"stale", stale},          {"invalid", invalid},
                           {"changed", changed},  {"frozen", result.frozen}, {"notes", result.notes},
                           {"pictures", pictures}};
    if (invalid > 0) {
        const auto first =
            std::find_if(result.pictures.begin(), result.pictures.end(),
                         [](const Checked& picture) { return picture.verdict == Verdict::kInvalid; });
        json["error"] = {{"code", static_cast<int>(ExitCode::kInvalidScene)},
                         {"message", printable_lines(first->cause)}};
    }
    console.report(std::move(json));
}

/// Runs a suite. A signal ends it with the number of pictures that were compared by then.
golden::SuiteResult run_until_asked(golden::SuiteDef& def) {
    std::int64_t compared = 0;
    std::int64_t all = 0;
    def.film.on_progress = stopping_if_asked();
    def.on_progress = [&](std::int64_t done, std::int64_t total) {
        compared = done;
        all = total;
        stop_if_asked();
        return true;
    };
    try {
        return golden::run(def);
    } catch (const Error&) {
        // Afterwards an update is published, whose errors say what became of it.
        if (interruption() == ExitCode::kOk || compared == all) throw;
        throw Error(interruption(), fmt::format("interrupted after {} of {}; nothing was written", compared,
                                                counted(all, "picture")));
    }
}

ExitCode run_suite(const Console& console, GoldenOptions options) {
    if ((options.def.dry_run || options.def.replan || options.def.force) && !options.def.update)
        throw Error(ExitCode::kUsage, "--dry-run, --replan and --force say how --update works; add --update");
    for (const std::string& path : {options.junit, options.html})
        if (!path.empty()) check_output(path, "", true);
    if (!options.html.empty()) options.def.most_drawn = kMaxOnPage;
    options.gl.apply_to(options.def.film);
    const golden::SuiteResult result = run_until_asked(options.def);
    const CancelScope finishing({}, CancelScope::Outer::kIgnored);  // an update has been published
    if (!options.junit.empty()) write_text(options.junit, golden::junit_xml(result));
    if (!options.html.empty()) write_text(options.html, golden::page_html(result, options.def.folder));
    tell(console, options, result);
    if (result.count(Verdict::kInvalid) > 0) return ExitCode::kInvalidScene;
    const bool failed = std::any_of(result.pictures.begin(), result.pictures.end(),
                                    [](const Checked& picture) { return picture.failed(); });
    return failed ? ExitCode::kMismatch : ExitCode::kOk;
}

}  // namespace

void add_golden(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "golden",
        "draw the scenes that have a table [golden] and compare them with kept pictures", run_suite);
    command
        .add_option("SCENE", options.def.paths, "scene files, or folders with them in it or in its folders")
        ->required();
    command.add_option("--dir", options.def.folder, "folder of the kept pictures")->required();
    command.add_flag("--update", options.def.update,
                     "write pictures that are missing or differ, and remove stale ones");
    command.add_flag("--dry-run", options.def.dry_run, "with --update: only say what would change");
    command.add_flag(
        "--force", options.def.force,
        "with --update: also replace files that are no PNG, and remove pictures without a record");
    command.add_flag("--replan", options.def.replan,
                     "with --update: choose new solvers and cameras instead of those of the kept pictures");
    command.add_option("--html", options.html,
                       "also write a page of the failed pictures: reference, new and difference");
    command.add_option("--junit", options.junit, "also write the results as JUnit XML to this file");
    command.add_option("--set", options.def.settings, "key=value in place of what the scenes say")
        ->type_name("KEY=VALUE");
    options.gl.add_to(command);
}

}  // namespace corda::app
