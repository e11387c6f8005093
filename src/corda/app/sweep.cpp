#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/figures/sweep_figures.hpp"
#include "corda/sweep/sweep.hpp"

namespace corda::app {
namespace {

struct SweepOptions {
    std::string path;
    std::string folder;
    std::string shard;
    int jobs = 0;
    bool checks = false;
    bool force = false;
    GlOptions gl;
    std::vector<std::string> plots;
    bool sheet = false;
};

ExitCode check(const Console& console, const sweep::SweepDef& def, const SweepOptions& options) {
    const auto problems = sweep::check_sweep(def, options.folder, show_progress(console, "check"));
    for (const std::string& problem : problems) console.warning(problem);
    if (problems.empty())
        console.result(fmt::format("{}: all shards are as they were written", options.folder));
    console.report(
        {{"schema", 1}, {"output", options.folder}, {"ok", problems.empty()}, {"problems", problems}});
    return problems.empty() ? ExitCode::kOk : ExitCode::kMismatch;
}

/// Runs a sweep; the message of an interruption names the finished shards.
sweep::RunResult run(const sweep::SweepDef& def, const sweep::RunDef& how) {
    try {
        return sweep::run_sweep(def, how);
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
        throw_error(error.code(), "interrupted: finished shards stay in {}; run it again for the others",
                    how.folder);
    }
}

ExitCode sweep(const Console& console, const SweepOptions& options) {
    const double start_s = now_s();
    if (options.folder == "-")
        throw Error(ExitCode::kUsage, "-o -: a sweep has several files; give a folder");
    const sweep::SweepDef def = sweep::load_sweep(options.path);
    for (const std::string& columns : options.plots)
        static_cast<void>(figures::sweep_plot_titles(def, columns));
    if (options.checks) return check(console, def, options);
    sweep::RunDef how{.folder = options.folder, .jobs = options.jobs, .force = options.force};
    if (!options.shard.empty()) how.shard = parse_shard(options.shard);
    options.gl.apply_to(how.film);
    how.on_progress = show_progress(console, "sweep");
    const sweep::RunResult result = run(def, how);
    const double wall_s = now_s() - start_s;
    if (result.shards_made < result.shards)
        console.info(fmt::format("{} of {} shards were there already", result.shards - result.shards_made,
                                 result.shards));
    if (result.samples_made > 0)
        console.info(fmt::format("{} made, {} in {:.3g} s, {:.1f} per second",
                                 counted(result.shards_made, "shard"), counted(result.samples_made, "sample"),
                                 wall_s, static_cast<double>(result.samples_made) / wall_s));
    if (result.is_complete && result.failed == def.samples)
        throw_error(ExitCode::kInvalidScene, "all samples were refused; the first, {}", result.first_failure);
    if (result.failed > 0)
        console.warning(fmt::format("{} refused, see column \"failure\" of metadata.csv; the first, {}",
                                    counted(result.failed, "sample"), result.first_failure));
    if (!result.is_complete)
        console.info("other shards are missing; run it without --shard when they are done");
    console.result(options.folder);
    std::vector<std::string> figures;
    for (const std::string& columns : options.plots) {
        const auto paths = figures::write_sweep_plot(def, options.folder, columns);
        figures.insert(figures.end(), paths.begin(), paths.end());
    }
    if (options.sheet) figures.push_back(figures::write_sweep_sheet(def, options.folder));
    for (const std::string& path : figures) console.result(path);
    console.report({{"schema", 1},
                    {"output", options.folder},
                    {"samples", def.samples},
                    {"shards", result.shards},
                    {"shards_made", result.shards_made},
                    {"samples_made", result.samples_made},
                    {"failed", result.failed},
                    {"complete", result.is_complete},
                    {"figures", figures},
                    {"wall_s", wall_s}});
    return ExitCode::kOk;
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
    auto [command, options] =
        add_command(app, action, "sweep", "make many samples of a scene as a labelled data set", sweep);
    command
        .add_option("SWEEP", options.path,
                    "sweep file: a scene and the keys that vary, or - for standard input")
        ->required();
    command.add_option("-o,--output", options.folder, "folder of the shards, metadata.csv and manifest.json")
        ->required();
    options.gl.add_to(command);
    command.add_option("--jobs", options.jobs, "samples made at a time; 0: one per core")
        ->check(within(0, EncoderDef::kMaxThreads));
    auto* const shard = command
                            .add_option("--shard", options.shard,
                                        "make only every N-th shard file, from shard file I (0 .. N - 1) on")
                            ->type_name("I/N");
    auto* const check =
        command.add_flag("--check", options.checks, "read all shards again, and make none")->excludes(shard);
    command
        .add_option(
            "--plot", options.plots,
            "draw a figure of the samples over another one, or over a key that varies; more than once: "
            "several plots")
        ->type_name("Y:X")
        ->excludes(check);
    command.add_flag("--sheet", options.sheet, "draw a contact sheet of 36 samples or fewer")
        ->excludes(check);
    command
        .add_flag("--force", options.force,
                  "replace the shards of another sweep, and make finished ones again")
        ->excludes(check)
        ->excludes(shard);
}

}  // namespace corda::app
