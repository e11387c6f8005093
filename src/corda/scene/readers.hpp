#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/scene/table_reader.hpp"

namespace corda::scene {

/// Bars shorter than this have no direction: the solvers' squared lengths come near the smallest number.
inline constexpr double kMinBarMetres = 1e-12;

// Defaults that no Def holds.
inline constexpr double kDefaultMassKg = 1.0;
inline constexpr int kDefaultReach = 7;  ///< the source report's

/// The names of the alternatives of SolverDef, in its order.
inline constexpr auto kMethodNames = []<class... Defs>(const std::variant<Defs...>*) {
    return std::array<std::string_view, sizeof...(Defs)>{Defs::kName...};
}(static_cast<const SolverDef*>(nullptr));

/// Calls `use` with the defaults of every alternative of SolverDef.
template <class Use>
void for_each_solver(const Use& use) {
    [&use]<class... Defs>(const std::variant<Defs...>*) {
        (use(Defs{}), ...);
    }(static_cast<const SolverDef*>(nullptr));
}

/// The method of a solver; std::nullopt for `auto`.
[[nodiscard]] inline std::optional<MethodDef> method_in(const SolverDef& solver) {
    return std::visit(
        [](const auto& def) -> std::optional<MethodDef> {
            if constexpr (std::is_same_v<std::decay_t<decltype(def)>, AutoDef>)
                return std::nullopt;
            else
                return def;
        },
        solver);
}

/// The keys of [solver], or of a table of [[solver.bodies]], in addition to those of its method.
struct SolverTable {
    std::string method{AutoDef::kName};
    std::vector<int> reach;  ///< of its ropes: one value if all are the same; empty: not given
    std::vector<std::uint32_t> ropes;
    std::vector<std::uint32_t> nets;
};

/// The tables of a scene file.
struct Sections {
    TableReader world;
    TableReader solver;
    TableReader video;
    TableReader style;
    TableReader overlay;
    TableReader camera;
    TableReader golden;
    std::vector<TableReader> ropes;
    std::vector<TableReader> nets;
};

/// A method and the bodies that it moves: the table [solver], or one of [[solver.bodies]].
struct SolverGroup {
    TableReader table;
    SolverDef def;
    int reach = 1;  ///< of the bars of its ropes
};

/// How the bodies of a scene are solved.
struct SolverSection {
    std::vector<SolverGroup> groups;         ///< [solver], then [[solver.bodies]]
    std::vector<std::size_t> group_of_body;  ///< an index of `groups` per body: ropes, then nets

    [[nodiscard]] const SolverGroup& group_of(std::size_t body) const { return groups[group_of_body[body]]; }
};

/// Sets `scene.solver` and `scene.body_solvers` too.
[[nodiscard]] SolverSection read_solver(const Sections& sections, Scene& scene);
[[nodiscard]] BodyStyleDef read_body_style(const TableReader& body, bool takes_link_colors);
/// Adds a problem if colours or arrows show a quantity that a named method does not compute. Sets
/// `scene.tensions_place`.
void check_tensions(const Sections& sections, const SolverSection& solver, Scene& scene);

/// A problem of several values together.
struct DefProblem {
    std::string_view key;
    std::optional<std::size_t> entry;  ///< of the key's list
    std::string what;
    std::string remedy;
};

[[nodiscard]] std::vector<DefProblem> problems_of(const VideoDef& video);
[[nodiscard]] std::vector<DefProblem> problems_of(const OverlayTextDef& text);
/// Plots of what the ropes do not have.
[[nodiscard]] std::vector<DefProblem> problems_of(const OverlayDef& overlay,
                                                  const std::vector<RopeDef>& ropes);
/// Ranges that are empty, or of plots that are not shown.
[[nodiscard]] std::vector<DefProblem> problems_of(const PlotRangesDef& ranges,
                                                  const std::vector<LivePlot>& plots);
/// Keys of things that are not shown, empty ranges, and trails of particles that no rope or net has.
[[nodiscard]] std::vector<DefProblem> problems_of(const StyleDef& style, const std::vector<RopeDef>& ropes,
                                                  const std::vector<NetDef>& nets);
/// `bodies`: number of ropes and nets.
[[nodiscard]] std::vector<DefProblem> problems_of(const CameraDef& camera, std::size_t bodies);
/// Golden times that do not increase, and pictures that are too large.
[[nodiscard]] std::vector<DefProblem> problems_of(const GoldenDef& golden);

/// Why the font of a scene does not show its texts; empty if it does.
[[nodiscard]] std::optional<Problem> problem_of_texts(const Scene& scene);

struct BodySize {
    std::int64_t particles = 0;
    std::int64_t bars = 0;
};

/// The size of a rope with bars to the next 1..reach particles, without making any. Empty if a problem, such
/// as a rope of two shapes, leaves it unknown.
[[nodiscard]] std::optional<BodySize> read_rope_size(const TableReader& rope, int reach);

struct SceneSize {
    std::vector<std::optional<BodySize>> bodies;  ///< ropes, then nets; empty if not known
    bool has_bars = false;                        ///< whether the bars of all bodies are known
    bool fits = true;                             ///< whether they are within the limits
};

/// Counts particles and bars without making any. Too many particles, bars or points of trails of all
/// bodies together are a problem.
[[nodiscard]] SceneSize count_bodies(const Sections& sections, const SolverSection& solver,
                                     const Scene& scene);

/// Adds a problem if the video has no frame or too many, or the simulation would take too many steps or bar
/// updates, by each body's own method.
void check_work(const Sections& sections, const SolverSection& solver, const SceneSize& size,
                const Scene& scene);

/// A rope whose size `read_rope_size` has found, and its shape. If the size is not known, the particles are
/// left out.
[[nodiscard]] RopeDef read_rope(const TableReader& rope, const std::optional<BodySize>& size, int reach,
                                ShapeDef& shape);

/// The size of a net, as `read_rope_size`.
[[nodiscard]] std::optional<BodySize> read_net_size(const TableReader& net);

/// A net, as `read_rope`: no bar has the length 0, none is there twice.
[[nodiscard]] NetDef read_net(const TableReader& net, const std::optional<BodySize>& size, ShapeDef& shape);

// What ropes and nets have in common.

[[nodiscard]] std::vector<double> read_mass(const TableReader& body, std::int64_t particles);
[[nodiscard]] std::vector<Vec2> read_velocity(const TableReader& body, std::int64_t particles);
/// The points of a body that has them, relative to `origin_m`: the key `origin`, or the first point. Adds a
/// problem if one is beyond the limit.
void read_points(const TableReader& body, Vec2& origin_m, std::vector<Vec2>& points_m);
/// Adds a problem if a body of another shape has the key `origin`.
void refuse_origin(const TableReader& body);

/// An index below `count`, negative ones counted from the end, as one from the beginning. If it is out of
/// range, `owner`, e.g. "the rope has particles", begins the rest of the message.
[[nodiscard]] std::optional<std::uint32_t> read_index(const Value& entry, std::int64_t count,
                                                      std::string_view owner);

/// Reads the index of a particle, or adds a problem.
using IndexOf = std::function<std::optional<std::uint32_t>(const Value&)>;

/// The particles of a list whose entries `index_of` understands; one that is there twice is a problem.
[[nodiscard]] std::vector<std::uint32_t> read_pinned(const Value& list, std::int64_t particles,
                                                     const IndexOf& index_of);

/// The moves of pins.
[[nodiscard]] std::vector<MoveDef> read_moves(const TableReader& body,
                                              const std::vector<std::uint32_t>& pinned,
                                              const IndexOf& index_of);
/// The pins that are let go.
[[nodiscard]] std::vector<ReleaseDef> read_releases(const TableReader& body,
                                                    const std::vector<std::uint32_t>& pinned,
                                                    const IndexOf& index_of);
/// The links that are cut, of a body with so many `links`.
[[nodiscard]] std::vector<CutDef> read_cuts(const TableReader& body, std::int64_t links);

}  // namespace corda::scene
