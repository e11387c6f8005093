#pragma once

#include <cstdint>
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
};

/// Finds the tables and refuses unknown keys. Throws kInvalidScene where `schema` is not 1 or there is no
/// rope.
[[nodiscard]] Sections read_sections(const Source& source, const toml::table& document);

[[nodiscard]] sim::WorldDef read_world(const TableReader& world);
[[nodiscard]] sim::SolverDef read_solver(const TableReader& solver);
[[nodiscard]] media::VideoDef read_video(const TableReader& video);
[[nodiscard]] view::StyleDef read_style(const TableReader& style);
[[nodiscard]] view::CameraDef read_camera(const TableReader& camera);
[[nodiscard]] view::RopeStyleDef read_rope_style(const TableReader& rope);

/// How many particles a rope asks for, without making any. Refuses a rope that does not have exactly one
/// shape.
[[nodiscard]] std::int64_t read_particle_count(const TableReader& rope);

/// A rope of `particles` as `read_particle_count` gave them; no link or bar up to `reach` has the length 0.
[[nodiscard]] sim::RopeDef read_rope(const TableReader& rope, std::int64_t particles, int reach);

/// The positions of a rope's particles, into `origin_m` and `points_m`.
void read_shape(const TableReader& rope, std::int64_t particles, int reach, sim::RopeDef& def);

}  // namespace corda::scene
