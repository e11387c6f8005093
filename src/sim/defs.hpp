#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "corda/sim/vec2.hpp"

namespace corda::sim {

/// What acts on everything in a scene, and for how long.
struct WorldDef {
    Vec2 gravity_m_s2{0.0, -9.81};  ///< acceleration of every free particle; finite
    double duration_s = 10.0;       ///< > 0
    double drag_1_s = 0.0;          ///< exact linear drag: velocities decay by exp(-drag t); >= 0
};

/// A chain of particles, each tied to the next by a bar of its initial length.
struct RopeDef {
    /// Where `points_m` are measured from, in metres. Kept apart so that a rope far from the origin has the
    /// same bits as one at the origin.
    Vec2 origin_m;
    std::vector<Vec2>
        points_m;  ///< start of every particle relative to `origin_m`; at least 2, neighbours apart
    std::vector<double> mass_kg;     ///< one a particle, > 0 (the pinned ones too)
    std::vector<Vec2> velocity_m_s;  ///< one a particle at t = 0; those of pinned particles are ignored
    std::vector<std::uint32_t> pinned{
        0};                   ///< indices of the particles that never move, each < points_m.size()
    double payload_kg = 0.0;  ///< added to the mass of the last particle; >= 0
};

/// How a scene is solved. kAuto is settled by a Plan (planner.hpp) before anything runs.
enum class Method { kAuto, kRelaxation, kRope, kExact };

/// How a scene is solved. A key that does not belong to the chosen method is refused by the scene reader.
struct SolverDef {
    Method method = Method::kAuto;
    double tolerance_px = 0.1;  ///< auto: bound of the displayed position error; > 0
    double tolerance =
        1e-9;  ///< exact: error after some seconds, relative to the rope's length; 1e-15 .. 1e-2
    std::optional<double> step_s;  ///< relaxation, rope: > 0; default one frame (relaxation), chosen (rope)
    int order = 4;                 ///< rope: order of the composition, 2, 4, 6 or 8
    int reach = 7;                 ///< relaxation: bars to the next 1..reach particles; >= 1
    int sweeps = 1;                ///< relaxation: passes over all bars a step; >= 1
    double delta = 0.0;            ///< relaxation: share of the velocity lost a step; 0 <= delta < 1
    std::optional<Vec2> force_n;   ///< relaxation: force on every particle in place of gravity
};

/// The name a scene file uses for a method.
[[nodiscard]] std::string_view method_name(Method method);

/// The method of that name; nothing where none of that name exists.
[[nodiscard]] std::optional<Method> parse_method(std::string_view name);

/// The names of the methods that exist, e.g. for an error message.
[[nodiscard]] std::vector<std::string_view> method_names();

}  // namespace corda::sim
