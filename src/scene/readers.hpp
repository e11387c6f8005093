#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/scene/table_reader.hpp"

namespace corda::scene {

/// The tables of a scene file, one reader each.
struct Sections {
    TableReader world;
    TableReader solver;
    TableReader video;
    TableReader style;
    TableReader camera;
    std::vector<TableReader> ropes;
    std::vector<TableReader> nets;
};

/// Finds the tables and refuses unknown keys. Throws kInvalidScene where `schema` is not 1 or there is
/// neither a rope nor a net.
[[nodiscard]] Sections read_sections(const Source& source, const toml::table& document);

[[nodiscard]] sim::WorldDef read_world(const TableReader& world);
[[nodiscard]] sim::SolverDef read_solver(const TableReader& solver);
[[nodiscard]] media::VideoDef read_video(const TableReader& video);
[[nodiscard]] view::StyleDef read_style(const TableReader& style);
[[nodiscard]] view::CameraDef read_camera(const TableReader& camera);
[[nodiscard]] view::BodyStyleDef read_body_style(const TableReader& body);

/// How many particles and bars a body asks for.
struct BodySize {
    std::int64_t particles = 0;
    std::int64_t bars = 0;
};

/// The size of a rope with bars up to `reach`, without making any. Refuses a rope that does not have exactly
/// one shape.
[[nodiscard]] BodySize read_rope_size(const TableReader& rope, int reach);

/// A rope of `particles` as `read_rope_size` gave them; no link or bar up to `reach` has the length 0.
[[nodiscard]] sim::RopeDef read_rope(const TableReader& rope, std::int64_t particles, int reach);

/// The positions of a rope's particles, into `origin_m` and `points_m`; `closed` is set.
void read_shape(const TableReader& rope, std::int64_t particles, int reach, sim::RopeDef& def);

/// The size of a net, without making any. Refuses one that does not have exactly one shape.
[[nodiscard]] BodySize read_net_size(const TableReader& net);

/// A net whose size `read_net_size` has found; no bar has the length 0, none is there twice.
[[nodiscard]] sim::NetDef read_net(const TableReader& net);

// What ropes and nets have in common.

/// In m. Shorter bars have no direction: the solvers' squared lengths come near the smallest number.
inline constexpr double kShortestBar = 1e-12;

/// Masses in kg of particles and payloads.
inline constexpr Range kMass{.low = 1e-12, .high = 1e12};

[[nodiscard]] std::vector<double> read_mass(const TableReader& body, std::int64_t particles);
[[nodiscard]] std::vector<sim::Vec2> read_velocity(const TableReader& body, std::int64_t particles);
[[nodiscard]] sim::MaterialDef read_material(const TableReader& body);

/// An index below `count` that may be counted from the end, -1 the last, as one from the beginning. `owner`
/// is "the rope has particles" in the message for one out of range.
[[nodiscard]] std::int64_t read_index(const Value& entry, std::int64_t count, std::string_view owner,
                                      std::string_view remedy);

/// The particles of a list that `index_of` understands each entry of; refuses one that is there twice.
[[nodiscard]] std::vector<std::uint32_t> read_pinned(
    const Value& list, std::int64_t particles, std::string_view remedy,
    const std::function<std::int64_t(const Value&)>& index_of);

}  // namespace corda::scene
