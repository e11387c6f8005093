#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/media/defs.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

#pragma GCC visibility push(default)
namespace corda {

class GivenMotion;

/// Method `auto`: the loosest method that keeps its estimate of the displayed error below a tolerance.
struct AutoDef {
    static constexpr std::string_view kName = "auto";

    double tolerance_px = 0.1;  ///< bound of the displayed position error in pixels; > 0
};

/// A variant of AutoDef and all alternatives of another variant.
template <class Methods>
struct AutoOr;
template <class... Method>
struct AutoOr<std::variant<Method...>> : std::type_identity<std::variant<AutoDef, Method...>> {};

/// The solver of a scene: a method, or `auto`, which chooses one.
using SolverDef = AutoOr<MethodDef>::type;

/// Bodies with a method of their own.
struct BodySolverDef {
    std::vector<std::uint32_t> ropes;  ///< indices of Scene::ropes; every body at most once in a scene
    std::vector<std::uint32_t> nets;   ///< indices of Scene::nets; at least one rope or net
    MethodDef method;
};

/// The name a scene file uses for it.
[[nodiscard]] std::string_view solver_name(const SolverDef& solver);

/// The solver that runs a method.
[[nodiscard]] SolverDef solver_of(const MethodDef& method);

/// The golden pictures of a scene and the tolerances of the comparison.
struct GoldenDef {
    std::vector<double> at_s;  ///< times in seconds, increasing, at least one; 0 .. world.duration_s
    int width_px = 320;        ///< see is_picture_size()
    int height_px = 180;
    // If no limit is given, pictures must be equal; otherwise those given count. See DifferenceLimits.
    std::optional<double> max;    ///< largest difference of a channel, 0 .. 255
    std::optional<double> mean;   ///< mean difference over all channels and pixels, 0 .. 255
    std::optional<double> share;  ///< share of the pixels that differ at all, 0 .. 1
    std::string mask;  ///< PNG of the same size whose black pixels are not compared; from the scene's folder
};

// Shapes of bodies in a scene file. Written scenes and reported changes use them instead of points.

/// A straight rope: key `line`.
struct LineDef {
    int particles = 0;  ///< at least 2
    Vec2 from_m;        ///< the first particle
    Vec2 step_m;        ///< from one particle to the next

    friend bool operator==(const LineDef&, const LineDef&) = default;
};

/// A straight rope at an angle: key `hang`.
struct HangDef {
    int links = 0;  ///< at least 1
    double length_m = 0.0;
    double angle_deg = 0.0;  ///< from straight down, positive to +x
    Vec2 from_m;             ///< the first particle

    friend bool operator==(const HangDef&, const HangDef&) = default;
};

/// A rope of links that each have a length and an angle, such as a double pendulum: key `hang` with
/// `lengths`. Its rates are the rope's velocities, so that they are written and compared as these.
struct ArmsDef {
    std::vector<double> lengths_m;      ///< one per link, at least one
    std::vector<double> angles_deg;     ///< one per link, from straight down, positive to +x
    std::vector<double> rates_deg_s{};  ///< one per link, or empty: at rest
    Vec2 from_m;                        ///< the first particle

    friend bool operator==(const ArmsDef&, const ArmsDef&) = default;
};

/// A net of rows, particle row * columns + column with row 0 on top: key `grid`.
struct GridDef {
    int columns = 0;
    int rows = 0;  ///< columns * rows is at least 2
    Vec2 from_m;   ///< the upper left particle
    Vec2 spacing_m;
    bool has_diagonals = false;  ///< imaginary bars, two per cell

    friend bool operator==(const GridDef&, const GridDef&) = default;
};

/// Copies of a rope in a scene file, each a rope of its own, turned `angle_deg` further about its first pin.
struct CopiesDef {
    int count = 1;           ///< with the rope itself, 2 .. 10'000
    double angle_deg = 0.0;  ///< finite
};

using ShapeDef = std::variant<std::monostate, LineDef, HangDef, ArmsDef, GridDef>;

/// The particles of a rope, into `rope.origin_m` and `rope.points_m`. Requires a shape in its ranges.
void place(const LineDef& line, RopeDef& rope);
void place(const HangDef& hang, RopeDef& rope);
void place(const ArmsDef& arms, RopeDef& rope);
/// The velocities of all particles by the rates of the links, the first one at rest.
[[nodiscard]] std::vector<Vec2> velocities_m_s(const ArmsDef& arms);
/// The particles and the bars of a grid, into `net.origin_m`, `net.points_m` and `net.bars`.
void place(const GridDef& grid, NetDef& net);

/// A validated scene file, as definitions of the other modules.
struct Scene {
    std::string name;                   ///< the file's name without folder and ending
    std::string source;                 ///< the file's path, as messages name it
    std::string text;                   ///< TOML that parse_scene() has read; empty: code filled the scene in
    std::vector<std::string> settings;  ///< in place of what the text says
    WorldDef world;
    std::vector<RopeDef> ropes;
    std::vector<NetDef> nets;
    std::vector<BodyStyleDef> body_styles;  ///< one per body: ropes, then nets; may be shorter
    /// The shapes that the file gives, one per body as `body_styles`; may be shorter. Only for writing and
    /// comparing scenes, and ignored if place() does not give the body's points.
    std::vector<ShapeDef> shapes;
    SolverDef solver;                         ///< of the bodies that `body_solvers` does not name
    std::vector<BodySolverDef> body_solvers;  ///< empty: `solver` moves all
    StyleDef style;
    Place tensions_place;  ///< where a file asks to show tensions; empty: nowhere
    OverlayDef overlay;
    CameraDef camera;
    VideoDef video;
    std::optional<GoldenDef> golden;  ///< empty: the scene is no golden test
    bool has_duration = false;        ///< a file or a setting gives world.duration
    /// A motion in place of a simulated one; null: the scene is simulated. No part of a scene file. See
    /// give_motion().
    std::shared_ptr<const GivenMotion> given;
};

/// One `--set key=value` of the command line, e.g. "video.fps=30" or "rope[0].mass=2". The value is read as
/// TOML; one that is not TOML is taken as a string. An empty one removes the key, as if the scene did not
/// give it.
using Setting = std::string;

/// Reads a scene file, or standard input for "-", with `settings` in place of what it says. Throws
/// corda::Error: kIo if the file cannot be read, kInvalidScene with all that is wrong in it, one problem per
/// line, kUsage for a setting that is not key=value, kInterrupted if cancelled:
/// check_cancelled() is called some ten times a second in a scene of a million particles.
[[nodiscard]] Scene load_scene(const std::string& path, const std::vector<Setting>& settings = {});

namespace scene {

/// The bytes of a scene file or of a pipe; "-" is standard input. Throws corda::Error: kIo with the system's
/// reason, kInvalidScene if there are too many.
[[nodiscard]] std::string read_file(const std::string& path);

/// Name of the file at `path` in messages.
[[nodiscard]] std::string source_name(const std::string& path);

}  // namespace scene

/// Settings that do not come from the command line; messages name `place` before them in place of
/// --set.
struct PlacedSettings {
    std::string place;
    std::vector<Setting> settings;
};

/// The same for TOML text; `source_name` stands in the messages in place of the path. `more` come last.
[[nodiscard]] Scene parse_scene(std::string_view toml, const std::string& source_name,
                                const std::vector<Setting>& settings = {}, const PlacedSettings& more = {});

/// The texts of a scene that people write: title, texts and labels.
[[nodiscard]] std::vector<std::string> shown_texts(const Scene& scene);

/// The path of the file OverlayDef::font; empty if there is none.
[[nodiscard]] std::string font_path(const Scene& scene);

/// The particles and bars of a scene at t = 0: its ropes, then its nets.
[[nodiscard]] System system_of(const Scene& scene);

/// The system with the labels that files of numbers use: merged bodies without labels, such as copies, count
/// on from the labelled one before them, as in "8 kg 2".
[[nodiscard]] System named_in_files(const Scene& scene, System system);

/// Multiplies the values in pixels by `factor`, within the ranges of their keys. Keys that have their
/// defaults keep them; video.size and golden.size stay.
void scale_px(Scene& scene, double factor);

/// The scene in pictures of another size, in which what it says in pixels keeps its share of the shorter
/// side.
[[nodiscard]] Scene scaled_to(Scene scene, int width_px, int height_px);

/// Checks definitions filled in by code against the types, ranges and words of the keys of a scene file.
/// build_system() checks ropes and nets. Throws corda::Error (kInvalidScene), which names each bad key.
void check_definitions(const Scene& scene);

/// The solver of every body of a scene, in the order of System::bodies: ropes, then nets. Throws corda::Error
/// (kInvalidScene) for `body_solvers` that are not what their declaration says.
[[nodiscard]] std::vector<SolverDef> solvers_of(const Scene& scene);

}  // namespace corda
#pragma GCC visibility pop
