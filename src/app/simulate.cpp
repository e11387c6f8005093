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
    bool diagnostics = false;
    bool force = false;
    bool dry_run = false;
};

std::string csv_header(std::size_t particles, bool diagnostics) {
    std::string line = "t";
    for (std::size_t i = 0; i < particles; ++i) line += fmt::format(",x{},y{}", i, i);
    if (diagnostics) line += ",energy_error,strain,pin_force_n,largest_tension_n";
    return line + "\n";
}

/// A figure that the method does not have is an empty cell.
void write_figures(const sim::Figures& figures, std::string& line) {
    auto out = std::back_inserter(line);
    const auto write = [&out](const std::optional<double>& figure) {
        *out++ = ',';
        if (figure) fmt::format_to(out, "{:.17g}", *figure);
    };
    write(figures.energy_error);
    write(figures.strain);
    write(figures.loads ? std::optional(figures.loads->pin_force_n) : std::nullopt);
    write(figures.loads ? std::optional(figures.loads->largest_tension_n) : std::nullopt);
}

void write_row(const sim::Simulation& simulation, bool diagnostics, std::string& line) {
    const sim::State& state = simulation.state();
    const sim::Vec2 origin_m = simulation.system().origin_m;
    line.clear();
    auto out = std::back_inserter(line);
    fmt::format_to(out, "{:.17g}", state.time_s);
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        fmt::format_to(out, ",{:.17g},{:.17g}", origin_m.x + state.x_m[i], origin_m.y + state.y_m[i]);
    }
    if (diagnostics) write_figures(simulation.figures(), line);
    line += '\n';
}

nlohmann::json report(const scene::Scene& scene, const scene::Run& run,
                      const std::optional<scene::AutoPlan>& proof) {
    const sim::System& system = run.simulation().system();
    const sim::Diagnostics diagnostics = run.simulation().diagnostics();
    const sim::Figures& largest = diagnostics.largest;
    nlohmann::json json = {{"schema", 1},
                           {"method", sim::method_name(scene.solver.method)},
                           {"solver", describe(scene.solver)},
                           {"particles", system.particle_count()},
                           {"bars", system.bars.size()},
                           {"links", system.link_count()},
                           {"steps", diagnostics.steps},
                           {"wall_s", run.wall_s()},
                           {"energy_error", nullptr},
                           {"max_strain", largest.strain},
                           {"max_pin_force_n", nullptr},
                           {"max_tension_n", nullptr}};
    if (largest.energy_error) json["energy_error"] = *largest.energy_error;
    if (largest.loads) json["max_pin_force_n"] = largest.loads->pin_force_n;
    if (largest.loads) json["max_tension_n"] = largest.loads->largest_tension_n;
    report_proof(proof, json);
    return json;
}

/// What the run cost, in the unit that the method's cost is counted in.
std::string cost_text(const scene::Scene& scene, const scene::Run& run) {
    const sim::System& system = run.simulation().system();
    const bool relaxation = scene.solver.method == sim::Method::kRelaxation;
    const auto steps = static_cast<double>(run.simulation().diagnostics().steps);
    const double pieces = relaxation ? static_cast<double>(system.bars.size()) * scene.solver.sweeps
                                     : static_cast<double>(system.particle_count());
    if (steps * pieces == 0.0) return "no steps";
    return fmt::format("{:.0f} steps in {:.3g} s: {:.4g} updates/s, {:.3g} ns a {}", steps, run.wall_s(),
                       steps / run.wall_s(), 1e9 * run.wall_s() / (steps * pieces),
                       relaxation ? "bar" : "particle");
}

/// Runs all frame times; returns whether it got to the end.
bool run_to_end(const Console& console, const scene::Scene& scene, bool diagnostics, scene::Run& run,
                TextOutput* csv) {
    const std::int64_t last = scene.video.fps.last_frame_within(scene.world.duration_s);
    Progress progress(console, "simulate", last + 1);
    std::string line;
    for (std::int64_t k = 0; k <= last; ++k) {
        if (interruption() != ExitCode::kOk) return false;
        run.at(scene.video.fps.time_s(k));
        if (csv != nullptr) {
            write_row(run.simulation(), diagnostics, line);
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
    scene::Scene scene = options.scene.load();
    const bool to_file = !options.output.empty() && options.output != "-";
    if (to_file) check_output(options.output, options.scene.path, options.force);
    const auto proof = settle_method(console, scene);
    scene::Run run(scene);
    const sim::System& system = run.simulation().system();
    console.info(fmt::format("{}: {}, method {}", scene.name, scene::describe(system),
                             sim::method_name(scene.solver.method)));
    if (options.dry_run) return ExitCode::kOk;

    std::unique_ptr<TextOutput> csv;
    if (!options.output.empty()) {
        csv = std::make_unique<TextOutput>(options.output);
        csv->write(csv_header(system.particle_count(), options.diagnostics));
    }
    bool complete = false;
    try {
        complete = run_to_end(console, scene, options.diagnostics, run, csv.get());
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
    console.info(fmt::format("{}; largest strain {:.3g}", cost_text(scene, run),
                             run.simulation().diagnostics().largest.strain));
    if (to_file) console.result(options.output);
    console.report(report(scene, run, proof));
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
    command->add_flag("--diagnostics", options->diagnostics,
                      "add energy error, strain, pin force and tension to every row");
    command->add_flag("--force", options->force, "replace an existing output");
    command->add_flag("--dry-run", options->dry_run, "check everything and write nothing");
    command->callback([options, &action] {
        action = [options](const Console& console) { return simulate(console, *options); };
    });
}

}  // namespace corda::app
