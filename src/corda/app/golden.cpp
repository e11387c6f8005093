#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/suite.hpp"
#include "corda/serve/review.hpp"
#include "corda/serve/server.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

using golden::Checked;
using golden::Verdict;

struct GoldenOptions {
    golden::SuiteDef def;
    std::string shard;
    std::string junit;
    std::string html;
    std::string markdown;
    bool reviews = false;
    serve::ServerDef server;
};

/// A page of more pictures is too large to open.
constexpr int kMaxOnPage = 200;

/// "a.png: would be written: different: max 3, mean 0.1, share 0.02; world.drag is 1 and was 0".
std::string line_of(const Checked& picture, bool is_dry_run) {
    std::vector<std::string> parts;
    if (picture.verdict() == Verdict::kDifferent && picture.difference)
        parts.push_back("different: " + figures_text(picture));
    else if (picture.verdict() != Verdict::kPassed)
        parts.emplace_back(word_of(picture.verdict()));
    if (const std::string cause = cause_text(picture).whole; !cause.empty()) parts.push_back(cause);
    if (picture.failed() && picture.verdict() == Verdict::kMissing) parts.emplace_back("--update adds it");
    if (picture.failed() && picture.cause.kind == golden::Cause::Kind::kUnasked)
        parts.emplace_back("--update removes it");
    const bool is_stale = picture.verdict() == Verdict::kStale;
    const std::string change =
        fmt::format("{}{}: ", is_dry_run ? "would be " : "", is_stale ? "removed" : "written");
    return fmt::format("{}: {}{}", picture.name, picture.changed ? change : "", fmt::join(parts, "; "));
}

/// Reads "I/N", 0 <= I < N.
Shard parse_shard(const std::string& text) {
    Shard shard;
    const bool is_read = std::sscanf(text.c_str(), "%" SCNd64 "/%" SCNd64, &shard.index, &shard.count) == 2;
    if (!is_read || fmt::format("{}/{}", shard.index, shard.count) != text || shard.index < 0 ||
        shard.index >= shard.count)
        throw_usage("--shard {}: is not I/N, the number of this shard (0 .. N - 1) and how many there are",
                    text);
    return shard;
}

/// Prints failures, changes and totals.
void tell(const Console& console, const GoldenOptions& options, const golden::SuiteResult& result) {
    nlohmann::json pictures = nlohmann::json::array();
    for (const Checked& picture : result.pictures) {
        if (picture.verdict() == Verdict::kInvalid)
            console.error(picture.cause.message);
        else if (picture.failed() || picture.changed)
            console.result(line_of(picture, options.def.dry_run));
        pictures.push_back(golden::picture_json(picture));
    }
    for (const std::string& note : result.notes) console.warning(note);
    for (const std::string& detail : result.details) console.detail(detail);
    const std::int64_t missing = result.count(Verdict::kMissing);
    const std::int64_t invalid = result.count(Verdict::kInvalid);
    console.result(result.totals());
    if (missing > 0 && !is_there(options.def.folder))
        console.warning(fmt::format("there is no folder '{}'; --update makes it", options.def.folder));
    else if (missing > 0)
        console.info("--update draws the missing pictures and keeps them");
    nlohmann::json json = {{"schema", 1},
                           {"passed", result.count(Verdict::kPassed)},
                           {"failed", result.count(Verdict::kDifferent) + result.count(Verdict::kEmpty)},
                           {"missing", missing},
                           {"stale", result.count(Verdict::kStale)},
                           {"invalid", invalid},
                           {"changed", result.changed()},
                           {"notes", result.notes},
                           {"pictures", pictures}};
    if (invalid > 0) {
        const auto first = std::ranges::find(result.pictures, Verdict::kInvalid, &Checked::verdict);
        json["error"] = {{"code", static_cast<int>(ExitCode::kInvalidScene)},
                         {"message", printable_lines(first->cause.message)}};
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
        throw_error(interruption(), "interrupted after {} of {}; nothing was written", compared,
                    counted(all, "picture"));
    }
}

/// The text of a file; empty if there is none.
std::string text_of(const std::string& path) {
    std::error_code none;
    return std::filesystem::is_regular_file(path, none) ? file_bytes(path) : "";
}

/// Refuses to replace a file that is no report, which has `mark` in its first lines, unless `force` is set.
void check_report(const std::string& path, std::string_view mark, bool force) {
    constexpr std::size_t kHeadBytes = 400;
    const std::string text = text_of(path);
    const bool is_report = text.substr(0, kHeadBytes).find(mark) != std::string::npos;
    check_output(path, "", force || text.empty() || is_report);
}

/// A step summary of CI has what earlier steps and commands wrote.
void append_markdown(const std::string& path, const std::string& text) {
    const std::string before = text_of(path);
    save_file(path, before + (before.empty() ? "" : "\n") + text);
}

void check_options(const GoldenOptions& options) {
    const golden::SuiteDef& def = options.def;
    const auto refuse = [](const char* text) { throw Error(ExitCode::kUsage, text); };
    if (def.force && !def.update && options.html.empty() && options.junit.empty())
        refuse("--force says how --update and reports replace files; add --update, --html or --junit");
    if (def.dry_run && !def.update && def.accepted.empty())
        refuse("--dry-run says what --update or --accept would change; add one of them");
    if (!options.html.empty()) check_report(options.html, "Golden pictures", def.force);
    if (!options.junit.empty()) check_report(options.junit, "<testsuites", def.force);
    if (!options.markdown.empty()) check_output(options.markdown, "", true);
    if (def.new_folder.empty()) return;
    std::error_code none;
    if (std::filesystem::equivalent(def.new_folder, def.folder, none))
        refuse("--new would write to the folder of the kept pictures; name another folder");
    check_folder(def.new_folder);
}

/// Shows failed pictures on a page until it is closed there, and prints how many were written. Returns the
/// number of those that were not accepted.
std::size_t review(const Console& console, const GoldenOptions& options, const golden::SuiteResult& result) {
    constexpr int kWaitMs = 200;
    serve::Review review(options.def, result);
    std::optional<serve::Server> server(
        std::in_place, options.server,
        [&review](const serve::Request& request) { return review.answer(request); });
    tell_address(console, *server);
    if (console.json()) console.info(server->address());  // the result is the suite's
    console.info("open this address in a browser; Finish on the page or Ctrl-C here ends the review");
    while (!review.wait(kWaitMs) && interruption() == ExitCode::kOk) continue;
    server.reset();  // waits for what it is writing
    const std::size_t written = review.accepted_count();
    const std::size_t open = review.open_count();
    console.result(fmt::format("review: {} written to '{}', {} not accepted",
                               counted(static_cast<std::int64_t>(written), "picture"), options.def.folder,
                               open));
    return open;
}

ExitCode run_suite(const Console& console, GoldenOptions options) {
    check_options(options);
    std::optional<TemporaryFolder> drawn;
    if (options.reviews && options.def.new_folder.empty())
        options.def.new_folder = drawn.emplace().file("new");
    if (!options.shard.empty()) options.def.shard = parse_shard(options.shard);
    if (!options.html.empty()) options.def.most_drawn = kMaxOnPage;
    const golden::SuiteResult result =
        options.def.accepted.empty() ? run_until_asked(options.def) : golden::accept(options.def);
    const CancelScope finishing({}, CancelScope::Outer::kIgnored);  // an update has been published
    if (!options.junit.empty()) save_file(options.junit, golden::junit_xml(result));
    if (!options.html.empty()) save_file(options.html, golden::html_report(result));
    if (!options.markdown.empty()) append_markdown(options.markdown, golden::markdown(result));
    tell(console, options, result);
    if (result.count(Verdict::kInvalid) > 0) return ExitCode::kInvalidScene;
    bool failed = std::ranges::any_of(result.pictures, &Checked::failed);
    if (failed && options.reviews) {
        failed = review(console, options, result) > 0;
        if (interruption() != ExitCode::kOk) return interruption();
    }
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
    command
        .add_option("--only", options.def.only,
                    "only pictures with these names, or of scenes with these names; * stands for any text")
        ->type_name("NAME");
    command.add_option("--shard", options.shard, "only every N-th scene, from scene I (0 .. N - 1) on")
        ->type_name("I/N");
    auto* const stale = command.add_flag("--stale", options.def.stale_only,
                                         "draw nothing: only look for pictures that no scene asks for");
    auto* const update = command.add_flag("--update", options.def.update,
                                          "write pictures that are missing or differ, and remove stale ones");
    command.add_flag("--dry-run", options.def.dry_run,
                     "with --update or --accept: only say what would change");
    command.add_flag("--force", options.def.force,
                     "with --update: also replace files that are no PNG, and remove pictures without a "
                     "record; with --html and --junit: replace files that are no such reports");
    auto* const fresh = command
                            .add_option("--new", options.def.new_folder,
                                        "also write the failed pictures to this folder, for --accept")
                            ->type_name("DIR")
                            ->excludes(update);
    auto* const review =
        command
            .add_flag("--review", options.reviews,
                      "show failed pictures on a page in a browser, to accept or reject each")
            ->excludes(update, stale);
    for (CLI::Option* const option : add_server(command, options.server)) option->needs(review);
    command
        .add_option("--accept", options.def.accepted,
                    "draw nothing: keep the pictures that an earlier --new wrote to this folder")
        ->type_name("DIR")
        ->allow_extra_args(false)
        ->excludes(update, fresh, stale, review);
    command.add_option("--html", options.html,
                       "also write a page of the failed pictures: reference, new and difference");
    command.add_option("--markdown", options.markdown,
                       "also append the failures as Markdown to this file, such as a step summary of CI");
    command.add_option("--junit", options.junit, "also write the results as JUnit XML to this file");
    command.add_option("--set", options.def.settings, "key=value in place of what the scenes say")
        ->type_name("KEY=VALUE");
    add_gl(command, options.def.film);
}

}  // namespace corda::app
