#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "console.hpp"
#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "corda/film/provenance.hpp"
#include "corda/scene/scene.hpp"
#include "corda/serve/server.hpp"

namespace corda::app {

/// The action of the chosen subcommand; set by its `add_...` below once it is parsed.
using Action = std::function<ExitCode(const Console&)>;

/// Adds one subcommand to `app`; parsing it sets `action`.
using AddCommand = void(CLI::App& app, Action& action);
AddCommand add_render, add_still, add_strobe, add_sheet, add_simulate, add_compare, add_golden, add_watch,
    add_doctor, add_plan, add_init, add_examples, add_schema, add_completion, add_help;

/// The subcommands in the order of `corda --help`.
inline constexpr AddCommand* kCommands[] = {
    add_render, add_still, add_strobe, add_sheet,    add_simulate, add_compare,    add_golden, add_watch,
    add_doctor, add_plan,  add_init,   add_examples, add_schema,   add_completion, add_help};

/// A subcommand and the values of its options, which live as long as the program.
template <class Options>
struct NewCommand {
    CLI::App& command;
    Options& options;
};

/// Adds a subcommand whose action is `run` with its options, of which `Argument` is a value or a reference.
/// If they have a function `require`, it is called when they are parsed.
template <class Argument>
auto add_command(CLI::App& app, Action& action, const std::string& name, const std::string& help,
                 ExitCode (*run)(const Console&, Argument)) {
    using Options = std::remove_cvref_t<Argument>;
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(name, help);
    command->callback([options, run, &action] {
        if constexpr (requires { options->require(); }) options->require();
        action = [options, run](const Console& console) { return run(console, *options); };
    });
    return NewCommand<Options>{*command, *options};
}

/// The subcommand of that name; null if there is none.
[[nodiscard]] const CLI::App* find_command(const CLI::App& app, std::string_view name);

/// The names of the subcommands.
[[nodiscard]] std::vector<std::string> command_names(const CLI::App& app);

/// Advice for an unknown word: "did you mean render?", or all the words that are known.
[[nodiscard]] std::string advice(std::string_view word, const std::vector<std::string>& known);

/// Accepts a number from `low` to `high`. CLI::Range lets "nan" pass.
[[nodiscard]] CLI::Validator within(double low, double high);

/// A scene and what the command line puts in the place of its values.
struct SceneOptions {
    std::string path;
    std::string from;                ///< a picture or a video that carries its scene, in place of `path`
    std::string positions;           ///< a file of a given motion; empty: the scene is simulated
    std::vector<Setting> settings;   ///< of --set
    std::vector<Setting> shortcuts;  ///< of options such as --fps; they count after those of --set

    /// The file that no output may replace.
    [[nodiscard]] const std::string& input() const { return from.empty() ? path : from; }
    /// Throws CLI::RequiredError if there is no scene. To be called when the command line is parsed.
    void require() const;
};

/// SCENE and `--set`.
void add_scene(CLI::App& command, SceneOptions& scene);
/// `--from FILE` in place of SCENE.
void add_from(CLI::App& command, SceneOptions& scene);
/// `--positions FILE` in place of a simulation.
void add_positions(CLI::App& command, SceneOptions& scene);
/// Makes `--name VALUE` stand for `--set key=VALUE`.
void add_shortcut(CLI::App& command, SceneOptions& scene, const std::string& name, const std::string& key,
                  const std::string& help);
/// `--size WxH` for `--set video.size=[W,H]`.
void add_size(CLI::App& command, SceneOptions& scene);
/// `--fps`, whose help is `rate`, and `--duration`.
void add_timing(CLI::App& command, SceneOptions& scene, const std::string& rate = "frames per second");
/// Which OpenGL to draw with.
void add_gl(CLI::App& command, FilmDef& film);
/// `--port`, `--bind`, `--host` and `--token`; returns these options.
std::vector<CLI::Option*> add_server(CLI::App& command, serve::ServerDef& server);
/// Prints where the page is: the address as the result, those by other names as information.
void tell_address(const Console& console, const serve::Server& server);
/// `--fail-empty`.
void add_fail_empty(CLI::App& command, bool& fails);

/// A scene with the record of the file of `--from` that carries it.
struct Loaded {
    Scene scene;
    Provenance origin;  ///< empty without --from
};

/// Warns if another version made the file of --from, and of texts that no frame shows. Throws corda::Error as
/// load_scene does, but with kUsage if the scene is valid without the options other than --set: then the
/// command line is wrong, not the scene.
[[nodiscard]] Loaded load(const Console& console, const SceneOptions& options);

/// Gives a scene another picture size, as `--size` does.
void set_size(Scene& scene, int width_px, int height_px);

/// Frames FIRST <= k < END of a video; without an end, up to its last.
struct RequestedFrames {
    std::int64_t first = 0;
    std::optional<std::int64_t> end;
};

/// Reads "FIRST:END", either of which may be left out; std::nullopt for any other text.
[[nodiscard]] std::optional<RequestedFrames> parse_frames(std::string_view text);

/// Simulates a scene, shows how far that is once it takes more than a second, and reports the methods that
/// `auto` chose and their error estimates. `what` is done, in words of progress.
[[nodiscard]] Film make_film(const Console& console, const Scene& scene, FilmDef def,
                             const std::string& what);
/// Warns of plots, and of names of curves, that have no room.
void warn_of_room(const Console& console, const Film& film);
/// Warns if a method that the scene names took one of several ways. To be called when the motion is known.
void warn_of_branch(const Console& console, const Film& film);

/// The keys that every JSON result about a film has: method, sizes, error estimate, camera, passes; null for
/// unknown values. Simulates the film if necessary.
[[nodiscard]] nlohmann::json film_json(const Film& film);

/// Pictures in which nothing is in view.
struct EmptyPictures {
    std::int64_t count = 0;
    std::int64_t all = 0;  ///< empty or not
    double first_s = 0.0;
};

/// Warns of empty pictures; returns the exit code. `fails`: they are a failure. `camera`: the scene's.
[[nodiscard]] ExitCode report_empty(const Console& console, const EmptyPictures& empty, bool fails,
                                    const CameraDef& camera);

/// Reports the OpenGL driver and its platform with -v.
void report_gl(const Console& console, const GlInfo& gl);

}  // namespace corda::app
