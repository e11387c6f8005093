#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "console.hpp"
#include "corda/core/exit_code.hpp"
#include "corda/gl/context.hpp"
#include "corda/scene/auto_plan.hpp"
#include "corda/scene/scene.hpp"

namespace corda::app {

/// What the chosen subcommand does; set by its `add_...` below once it is parsed.
using Action = std::function<ExitCode(const Console&)>;

// Each adds one subcommand to `app`; parsing it sets `action`.
void add_render(CLI::App& app, Action& action);
void add_still(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);

/// A scene file and what the command line puts in the place of its values.
struct SceneOptions {
    std::string path;
    std::vector<std::string> settings;

    /// Whether a command can do without a scene.
    enum class Need { kRequired, kOptional };
    void add_to(CLI::App& command, Need need = Need::kRequired);
    /// Makes `--name VALUE` stand for `--set key=VALUE`.
    void add_shortcut(CLI::App& command, const std::string& name, const std::string& key,
                      const std::string& help);
    /// `--size WxH` for `--set video.size=[W,H]`.
    void add_size(CLI::App& command);
    [[nodiscard]] scene::Scene load() const { return scene::load_scene(path, settings); }
};

/// Which OpenGL to draw with.
struct GlOptions {
    std::string backend;
    bool require_gpu = false;

    void add_to(CLI::App& command);
    /// Throws corda::Error (kUsage) for an unknown backend.
    [[nodiscard]] gl::ContextDef def() const;
};

/// Shows how far a run is that comes before the one asked for, once that takes more than a second, and ends
/// it by a corda::Error where a signal asks for that. `console` has to outlive it.
[[nodiscard]] sim::FrameWatch preparation(const Console& console, const std::string& what);

/// Settles method auto and says what it became and how far it can be trusted.
[[nodiscard]] std::optional<scene::AutoPlan> settle_method(const Console& console, scene::Scene& scene);

/// Puts "error_bound_m", "error_bound_px" and "horizon_s" into a report; null where nothing was proved.
void report_proof(const std::optional<scene::AutoPlan>& proof, nlohmann::json& json);

/// The solver in words: "exact at tolerance 1e-08".
[[nodiscard]] std::string describe(const sim::SolverDef& solver);

/// Says with -v what draws, and how it was reached.
void report_gl(const Console& console, const gl::Context& context);

}  // namespace corda::app
