#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/csv.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/series.hpp"
#include "corda/film/swing.hpp"
#include "corda/sim/support_work.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

/// The columns in addition to the positions.
struct Columns {
    bool velocities = false;
    bool tensions = false;
    bool energy = false;
    bool diagnostics = false;

    friend bool operator==(const Columns&, const Columns&) = default;
};

struct SimulateOptions {
    SceneOptions scene;
    std::string output;
    Columns columns;
    CsvStyle style = CsvStyle::kPoint;
    bool force = false;
    bool dry_run = false;
};

/// The columns at the end of a row.
std::vector<film::Series> series_of(const Columns& columns) {
    std::vector<film::Series> all;
    if (columns.energy) all = {film::kSeries.energy_change, film::kSeries.kinetic, film::kSeries.potential};
    if (!columns.diagnostics) return all;
    for (const film::Series& one : {film::kSeries.energy_error, film::kSeries.strain, film::kSeries.pin_force,
                                    film::kSeries.largest_tension})
        all.push_back(one);
    return all;
}

/// Whether the last column is the work of the pins that move.
bool has_work(const System& system, const Columns& columns) {
    return columns.energy && !system.moves.empty();
}

/// How the columns of each body begin: with its label.
std::vector<std::string> column_prefixes(const System& named) {
    std::vector<std::string> prefixes = body_keys(named);
    for (std::size_t b = 0; b < prefixes.size(); ++b)
        prefixes[b] = named.bodies[b].label.empty() ? "" : prefixes[b] + "_";
    return prefixes;
}

/// The names of the columns, with units as the files of `report` have them. The time and the positions, in s
/// and m, have the names that scripts know.
std::string csv_header(const System& system, const Columns& columns, CsvStyle style) {
    CsvLine line(style);
    line.add("t");
    const std::vector<std::string> prefixes = column_prefixes(system);
    std::vector<std::string> labels;  // of particles
    std::vector<std::string> of_links;
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        labels.resize(labels.size() + system.bodies[b].particle_count, prefixes[b]);
        of_links.resize(of_links.size() + system.bodies[b].link_count, prefixes[b]);
    }
    for (std::size_t i = 0; i < labels.size(); ++i)
        for (const char axis : {'x', 'y'}) line.add(fmt::format("{}{}{}", labels[i], axis, i));
    for (std::size_t i = 0; columns.velocities && i < labels.size(); ++i)
        for (const char axis : {'x', 'y'}) line.add(fmt::format("{}v{}{}_m_s", labels[i], axis, i));
    for (std::size_t k = 0; columns.tensions && k < of_links.size(); ++k)
        line.add(fmt::format("{}tension{}_n", of_links[k], k));
    for (const film::Series& one : series_of(columns)) line.add(one.key);
    if (has_work(system, columns)) line.add("support_work_j");
    return std::string(line.end());
}

/// The particles and links of each body, by which the columns are numbered.
nlohmann::json bodies_json(const System& system) {
    nlohmann::json bodies = nlohmann::json::array();
    std::size_t link = 0;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        bodies.push_back({{"body", body_name(system, i)},
                          {"first_particle", body.first_particle},
                          {"particles", body.particle_count},
                          {"first_link", link},
                          {"links", body.link_count}});
        link += body.link_count;
    }
    return bodies;
}

/// The columns of each body, for people.
std::string columns_text(const System& system) {
    const std::vector<std::string> prefixes = column_prefixes(system);
    std::string text;
    for (std::size_t b = 0; b < prefixes.size(); ++b) {
        const std::size_t first = system.bodies[b].first_particle;
        text += fmt::format("{}{}: {}x{} .. {}y{}", text.empty() ? "columns of " : "; ", body_name(system, b),
                            prefixes[b], first, prefixes[b], first + system.bodies[b].particle_count - 1);
    }
    return text;
}

/// The passages of each rope's free end below its pin, until that is let go or the rope is cut.
class RopePassages {
  public:
    /// The motion must outlive this.
    explicit RopePassages(const film::Motion& motion) : system_(&motion.system) {
        for (const film::TrackedParticle& one : film::tracked_particles(*system_, system_->bodies.size()))
            if (one.pin && !system_->bodies[one.body].is_net) passages_.push_back({one, {}});
    }

    void include(const State& state) {
        for (auto& [tracked, passages] : passages_) {
            const Body& body = system_->bodies[tracked.body];
            bool is_whole = system_->is_pinned_at(*tracked.pin, state.time_s);
            for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
                is_whole = is_whole && system_->has_bar_at(k, state.time_s);
            const auto from_pin = [&, i = tracked.particle, pin = *tracked.pin](const auto& x,
                                                                                const auto& y) {
                return Vec2{x[i] - x[pin], y[i] - y[pin]};
            };
            if (is_whole)
                passages.include(state.time_s, from_pin(state.x_m, state.y_m),
                                 from_pin(state.vx_m_s, state.vy_m_s));
        }
    }

    [[nodiscard]] nlohmann::json json(const System& named) const {
        nlohmann::json ropes = nlohmann::json::array();
        for (std::size_t b = 0; b < named.bodies.size(); ++b) {
            if (named.bodies[b].is_net) continue;
            const auto one = std::ranges::find(passages_, b, [](const auto& of) { return of.first.body; });
            const film::Passages passages = one == passages_.end() ? film::Passages() : one->second;
            film::Period period{{}, "there is no pin, or several"};
            if (one != passages_.end()) period = passages.period();
            ropes.push_back({{"body", body_name(named, b)},
                             {"period_s", or_null(period.seconds)},
                             {"period_reason", nullptr},
                             {"passages_s", passages.times_s()}});
            if (!period.seconds) ropes.back()["period_reason"] = period.reason;
        }
        return ropes;
    }

  private:
    const System* system_;
    std::vector<std::pair<film::TrackedParticle, film::Passages>> passages_;
};

/// A number that the method does not know is an empty cell. `work`: null without its column.
void add_row(const film::Instant& instant, const Columns& columns, sim::SupportWork* work, CsvLine& line) {
    const State& state = instant.state;
    const System& system = instant.source.motion.system;
    const Vec2 origin_m = system.origin_m;
    line.add(state.time_s);
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        line.add(origin_m.x + state.x_m[i]);
        line.add(origin_m.y + state.y_m[i]);
    }
    for (std::size_t i = 0; columns.velocities && i < state.x_m.size(); ++i) {
        line.add(state.vx_m_s[i]);
        line.add(state.vy_m_s[i]);
    }
    for (std::size_t i = 0; columns.tensions && i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
            line.add(state.tension_n[k]);
    }
    for (const film::Series& one : series_of(columns)) line.add(one.value(instant));
    if (work != nullptr) line.add(work->until_j(state.time_s));
}

nlohmann::json report(const Film& film, const RopePassages& passages) {
    const Figures& largest = film.diagnostics().largest;
    nlohmann::json json = film_json(film);
    json["steps"] = film.diagnostics().steps;
    const System named = named_in_files(film.scene(), film.system());
    json["bodies"] = bodies_json(named);
    json["ropes"] = passages.json(named);
    json["wall_s"] = film.stepping_s();
    json["energy_error"] = or_null(largest.energy_error);
    json["max_strain"] = largest.strain;
    json["max_pin_force_n"] = nullptr;
    json["max_tension_n"] = nullptr;
    if (largest.loads) json["max_pin_force_n"] = largest.loads->pin_force_n;
    if (largest.loads) json["max_tension_n"] = largest.loads->largest_tension_n;
    return json;
}

/// Cost of the run.
std::string cost_text(const Film& film) {
    const auto steps = static_cast<double>(film.diagnostics().steps);
    if (steps == 0.0) return "no steps";
    const double wall_s = film.stepping_s();
    return fmt::format("{:.0f} steps in {:.3g} s: {:.4g} steps/s", steps, wall_s, steps / wall_s);
}

/// Writes the states of all frame times as CSV; without a file, only simulates.
void write_states(const Console& console, const Film& film, const SimulateOptions& options, OutputFile* csv,
                  RopePassages* passages) {
    Progress progress(console, "simulate", film.last_frame() + 1);
    if (csv != nullptr) {
        if (options.style == CsvStyle::kComma) csv->write("\xef\xbb\xbf");  // Excel reads UTF-8 by it
        csv->write(csv_header(named_in_files(film.scene(), film.system()), options.columns, options.style));
    }
    CsvLine line(options.style);
    const film::Motion& motion = film.motion();
    const film::SeriesSource source(motion);
    std::optional<sim::SupportWork> work;
    if (has_work(motion.system, options.columns))
        work.emplace(motion.system, motion.world, motion.methods(), motion.timeline->step_s());
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        check_cancelled();
        const double time_s = film.time_s(k);
        motion.for_each({&time_s, 1}, [&](const State& state, const Figures& figures) {
            if (passages != nullptr) passages->include(state);
            if (csv == nullptr) return;
            add_row({source, state, figures}, options.columns, work ? &*work : nullptr, line);
            csv->write(line.end());
        });
        progress.update(k + 1);
    }
}

/// Warns of bodies whose tensions are missing.
void warn_of_tensions(const Console& console, const Film& film) {
    const System& system = film.system();
    const State state = film.state(0);
    std::vector<std::size_t> unknown;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const auto first = state.tension_n.begin() + static_cast<std::ptrdiff_t>(system.bodies[i].first_bar);
        if (std::any_of(first, first + static_cast<std::ptrdiff_t>(system.bodies[i].link_count),
                        [](double tension_n) { return std::isnan(tension_n); }))
            unknown.push_back(i);
    }
    for (const MethodGroup& group : groups_of(film.plan())) {
        std::vector<std::size_t> bodies;
        std::set_intersection(group.bodies.begin(), group.bodies.end(), unknown.begin(), unknown.end(),
                              std::back_inserter(bodies));
        if (bodies.empty()) continue;
        console.warning(fmt::format("--tension: the tensions of {} are left empty: {}",
                                    bodies_text(system, bodies),
                                    unknown_tensions_text(film.plan().bodies[bodies.front()])));
    }
}

/// Refuses an ending that is not known; a device such as /dev/null needs none.
void check_ending(const std::string& output) {
    const std::filesystem::path path(output);
    std::error_code ignored;
    const bool is_device =
        std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored);
    if (output.empty() || is_standard_output(output) || path.extension() == ".csv" || is_device) return;
    throw_usage("-o {}: states are written as .csv; give such a name, or - for CSV on standard output{}",
                output, path.extension() == ".npz" ? "; for arrays of NumPy, use corda.Film in Python" : "");
}

/// Simulates the motion and writes it, if there is an output. `passages`: null if they are not asked for.
void write_output(const Console& console, const Film& film, const SimulateOptions& options,
                  RopePassages* passages) {
    std::unique_ptr<OutputFile> file;
    if (!options.output.empty()) {
        file = std::make_unique<OutputFile>(options.output, OutputOptions{.force = options.force});
        constexpr std::size_t kMaxNamedBodies = 20;
        const std::size_t bodies = film.system().bodies.size();
        if (bodies > 1 && bodies <= kMaxNamedBodies)
            console.info(columns_text(named_in_files(film.scene(), film.system())));
    }
    try {
        if (options.columns.tensions) warn_of_tensions(console, film);
        write_states(console, film, options, file.get(), passages);
    } catch (const Error& error) {
        const bool ends_early = error.code() == ExitCode::kDiverged || error.code() == interruption();
        if (!file || !ends_early) throw;
        const std::string kept = file->keep();
        if (is_standard_output(options.output)) throw;
        throw_error(error.code(), "{}; the rows before it are in {}", error.what(), kept);
    }
    if (file) file->commit();
}

ExitCode simulate(const Console& console, const SimulateOptions& options) {
    const bool to_stdout = is_standard_output(options.output);
    if (to_stdout && console.json()) {
        throw Error(ExitCode::kUsage, "-o - and --json both want standard output; give the CSV a file name");
    }
    check_ending(options.output);
    if (options.output.empty() && (options.columns != Columns() || options.style != CsvStyle::kPoint))
        console.warning(
            "--velocity, --tension, --energy, --diagnostics and --decimal change the file of -o "
            "alone; add -o FILE, or -o - for standard output");
    const Scene scene = load(console, options.scene).scene;
    const bool to_file = !options.output.empty() && !to_stdout;
    if (to_file) check_output(options.output, options.scene.path, options.force, OutputKind::kStream);
    FilmDef def;
    def.clock_s = now_s;
    def.readings = {.velocities = options.columns.velocities || console.json(),
                    .tensions = options.columns.tensions,
                    .unknown_tensions = options.columns.tensions};
    for (const film::Series& one : series_of(options.columns)) def.readings = def.readings.with(one.fields);
    const Film film = make_film(console, scene, def, "plan");
    console.info(fmt::format("{}: {}, method {}", film.scene().name, system_text(film.system()),
                             method_names(film.plan())));
    if (options.dry_run) {
        console.report(film_json(film));
        return ExitCode::kOk;
    }

    set_interruption_message(kSomethingWritten);
    RopePassages passages(film.motion());
    write_output(console, film, options, console.json() ? &passages : nullptr);
    const Figures& largest = film.diagnostics().largest;
    console.info(
        fmt::format("{}; largest strain {:.3g}{}", cost_text(film), largest.strain,
                    largest.energy_error ? fmt::format(", energy error {:.3g}", *largest.energy_error) : ""));
    warn_of_branch(console, film);
    if (to_file) console.result(options.output);
    console.report(report(film, passages));
    return ExitCode::kOk;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
    auto [command, options] =
        add_command(app, action, "simulate",
                    "run the simulation alone; positions as CSV, figures and periods as JSON", simulate);
    add_scene(command, options.scene);
    command.add_option(
        "-o,--output", options.output,
        "CSV file, or - for standard output; none: figures only. The first line names the columns: t in s, "
        "x0, y0, ... in m, after the label of a rope or net that has one");
    add_timing(command, options.scene, "rows per second");
    command.add_flag("--velocity", options.columns.velocities,
                     "add the velocity of every particle: vx0_m_s, vy0_m_s, ...");
    command.add_flag(
        "--tension", options.columns.tensions,
        "add the tension of every link, positive if it pulls: tension0_n, ...; empty if the method does "
        "not know it");
    command.add_flag(
        "--energy", options.columns.energy,
        "add the change of the energy since the start, and its parts: energy_change_j, kinetic_j, "
        "potential_j, in which the weight has 0 J at the start; and the work of pins that move: "
        "support_work_j");
    command.add_flag("--diagnostics", options.columns.diagnostics,
                     "add energy error, strain, pin force and tension to every row");
    command
        .add_option_function<std::string>(
            "--decimal",
            [&style = options.style](const std::string& word) {
                style = word == "comma" ? CsvStyle::kComma : CsvStyle::kPoint;
            },
            "decimal sign of CSV: point, or comma with semicolons between the cells and a byte order mark, "
            "as Excel needs them")
        ->check(CLI::IsMember({"point", "comma"}))
        ->type_name("point|comma");
    command.add_flag("--force", options.force, "replace an existing output");
    command.add_flag("--dry-run", options.dry_run, "check everything and write nothing");
}

}  // namespace corda::app
