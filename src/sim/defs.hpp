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

/// What a body's bars are made of. By default they keep their lengths; a term that is not asked for costs
/// nothing.
struct MaterialDef {
    /// Strain of a bar per newton of tension, 1 / (E A), in 1/N; 0: rigid, else the bars stretch by Hooke's
    /// law.
    double compliance_1_n = 0.0;
    /// Bars pull and never push. Rigid ones that come taut do so plastically: momentum is kept, and the
    /// relative velocity along the bar is gone (a string). With compliance: no force while shorter than at
    /// rest (a bungee).
    bool is_string = false;
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
    bool closed = false;      ///< the last particle is tied to the first one too; needs at least 3
    /// Lengths of the links at rest, one a link (the closing one last), > 0; empty: the initial distances.
    /// Others than these only for a material that stretches, or that may hang slack: at least the distance
    /// there.
    std::vector<double> rest_m;
    MaterialDef material;
    /// Bending stiffness E I in N m^2, >= 0: the energy E I / a (1 - cos(angle)) at every inner particle, a
    /// being the mean of the two links' lengths at rest; 0: perfectly flexible. A link between two pins
    /// clamps.
    double bending_n_m2 = 0.0;
};

/// A bar of a net between particles `a` and `b`.
struct NetBar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    bool is_real = true;  ///< false: it stiffens the net and is not part of it (a diagonal)
};

/// Particles and bars in any graph, e.g. a cloth.
struct NetDef {
    Vec2 origin_m;                   ///< as of a RopeDef
    std::vector<Vec2> points_m;      ///< relative to `origin_m`; at least 2
    std::vector<double> mass_kg;     ///< one a particle, > 0
    std::vector<Vec2> velocity_m_s;  ///< one a particle
    std::vector<NetBar> bars;        ///< in the order of relaxation, real ones first; a != b, no pair twice
    std::vector<std::uint32_t> pinned;
    MaterialDef material;
};

/// How a scene is solved. kAuto is settled by a Plan (planner.hpp) before anything runs.
enum class Method { kAuto, kRelaxation, kRope, kExact };

/// How a scene is solved. A key that does not belong to the chosen method is refused by the scene reader.
struct SolverDef {
    Method method = Method::kAuto;
    double tolerance_px = 0.1;  ///< auto: bound of the displayed position error; > 0
    double tolerance = 1e-9;  ///< exact: error after some seconds, relative to the rope's length; 1e-15 .. 1
    std::optional<double> step_s;  ///< relaxation, rope: > 0; default one frame (relaxation), chosen (rope)
    int order = 4;                 ///< rope: order of the composition, 2, 4, 6 or 8
    int reach = 7;                 ///< relaxation: bars to the next 1..reach particles; >= 1
    int sweeps = 1;                ///< relaxation: passes over all bars a step; >= 1
    double delta = 0.0;            ///< relaxation: share of the velocity lost a step; 0 <= delta < 1
    std::optional<Vec2> force_n;   ///< relaxation: force on every particle in place of gravity
};

/// `exact` at a tolerance, on the links alone.
[[nodiscard]] SolverDef exact_solver(double tolerance);

/// `rope` of an order, on the links alone, at a step in seconds or the one that it chooses.
[[nodiscard]] SolverDef rope_solver(int order, std::optional<double> step_s = std::nullopt);

/// `relaxation` at a step in seconds, with weights in place of the report's constant force.
[[nodiscard]] SolverDef relaxation_solver(double step_s, int reach, int sweeps);

/// The name a scene file uses for a method.
[[nodiscard]] std::string_view method_name(Method method);

/// The method of that name; nothing where none of that name exists.
[[nodiscard]] std::optional<Method> parse_method(std::string_view name);

/// The names of the methods that exist, e.g. for an error message.
[[nodiscard]] std::vector<std::string_view> method_names();

}  // namespace corda::sim
