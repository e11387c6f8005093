#include <iterator>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/scene/player.hpp"
#include "interrupt.hpp"
#include "output.hpp"

namespace corda::app {
namespace {

struct SimulateOptions {
    SceneOptions scene;
    std::string output;
    bool force = false;
    bool dry_run = false;
};

std::string csv_header(std::size_t particles) {
    std::string line = "t";
    for (std::size_t i = 0; i < particles; ++i) line += fmt::format(",x{},y{}", i, i);
    return line + "\n";
}

void write_row(const sim::State& state, sim::Vec2 origin_m, std::string& line) {
    line.clear();
    auto out = std::back_inserter(line);
    fmt::format_to(out, "{:.17g}", state.time_s);
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        fmt::format_to(out, ",{:.17g},{:.17g}", origin_m.x + state.x_m[i], origin_m.y + state.y_m[i]);
    }
    line += '\n';
}

nlohmann::json report(const scene::Scene& scene, const scene::Run& run) {
    const sim::System& system = run.simulation().system();
    const sim::Diagnostics figures = run.simulation().diagnostics();
    nlohmann::json json = {{"schema", 1},
                           {"method", sim::method_name(scene.solver.method)},
                           {"particles", system.particle_count()},
                           {"bars", system.bars.size()},
                           {"links", system.link_count()},
                           {"steps", figures.steps},
                           {"wall_s", run.wall_s()},
                           {"energy_error", nullptr},
                           {"max_strain", figures.max_strain},
                           {"error_bound_m", nullptr},
                           {"error_bound_px", nullptr},
                           {"horizon_s", nullptr}};
    if (figures.energy_error) json["energy_error"] = *figures.energy_error;
    return json;
}

/// Runs all frame times; returns whether it got to the end.
bool run_to_end(const Console& console, const scene::Scene& scene, scene::Run& run, TextOutput* csv) {
    const sim::Vec2 origin_m = run.simulation().system().origin_m;
    const std::int64_t last = scene.video.fps.last_frame_within(scene.world.duration_s);
    Progress progress(console, "simulate", last + 1);
    std::string line;
    for (std::int64_t k = 0; k <= last; ++k) {
        if (interruption() != ExitCode::kOk) return false;
        const sim::State& state = run.at(scene.video.fps.time_s(k));
        if (csv != nullptr) {
            write_row(state, origin_m, line);
            csv->write(line);
        }
        progress.update(k + 1);
    }
    return true;
}

ExitCode simulate(const Console& console, const SimulateOptions& options) {
    if (options.output == "-" && console.json()) {
        throw Error(ExitCode::kUsage, "-o - and --json both want standard output; give the CSV a file name");
    }
    const scene::Scene scene = options.scene.load();
    const bool to_file = !options.output.empty() && options.output != "-";
    if (to_file) check_output(options.output, options.scene.path, options.force);
    scene::Run run(scene);
    const sim::System& system = run.simulation().system();
    console.info(fmt::format("{}: {}, method {}", scene.name, scene::describe(system),
                             sim::method_name(scene.solver.method)));
    if (options.dry_run) return ExitCode::kOk;

    std::unique_ptr<TextOutput> csv;
    if (!options.output.empty()) {
        csv = std::make_unique<TextOutput>(options.output);
        csv->write(csv_header(system.particle_count()));
    }
    bool complete = false;
    try {
        complete = run_to_end(console, scene, run, csv.get());
    } catch (const Error& error) {
        if (!to_file || error.code() != ExitCode::kDiverged) throw;
        throw Error(error.code(),
                    fmt::format("{}; the rows before it are in {}", error.what(), csv->part_path()));
    }
    if (!complete) {
        if (to_file) console.warning(fmt::format("interrupted; the rows so far are in {}", csv->part_path()));
        return interruption();
    }
    if (csv) csv->finish();
    const sim::Diagnostics figures = run.simulation().diagnostics();
    console.info(fmt::format("{} steps in {:.3g} s: {:.4g} updates/s, {:.3g} ns a bar; largest strain {:.3g}",
                             figures.steps, run.wall_s(), static_cast<double>(figures.steps) / run.wall_s(),
                             1e9 * run.wall_s() /
                                 static_cast<double>(figures.steps * system.bars.size() *
                                                     static_cast<std::size_t>(scene.solver.sweeps)),
                             figures.max_strain));
    if (to_file) console.result(options.output);
    console.report(report(scene, run));
    return ExitCode::kOk;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
    auto options = std::make_shared<SimulateOptions>();
    CLI::App* command =
        app.add_subcommand("simulate", "run the simulation alone; positions as CSV, figures as JSON");
    options->scene.add_to(*command);
    command->add_option("-o,--output", options->output,
                        "CSV file, or - for standard output; none: figures only");
    options->scene.add_shortcut(*command, "--fps", "video.fps", "rows a second");
    options->scene.add_shortcut(*command, "--duration", "world.duration", "seconds");
    command->add_flag("--force", options->force, "replace an existing output");
    command->add_flag("--dry-run", options->dry_run, "check everything and write nothing");
    command->callback([options, &action] {
        action = [options](const Console& console) { return simulate(console, *options); };
    });
}

}  // namespace corda::app
