#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "corda/sim/defs.hpp"

namespace corda::sim {

/// One body's place among the particles and the bars of a System: a rope or a net.
struct Body {
    std::size_t first_particle = 0;
    std::size_t particle_count = 0;
    std::size_t first_bar = 0;
    std::size_t bar_count = 0;   ///< all of them
    std::size_t link_count = 0;  ///< real ones; they come first
    bool is_chain = true;        ///< link k joins particle k to particle k + 1 and there are no others
    bool is_net = false;         ///< made from a NetDef
    MaterialDef material;
};

/// Two particles held at a distance. A bar of reach 1 is real (a link of a rope); a bar of a longer reach is
/// imaginary: it stiffens the rope or the net and is not part of it.
struct Bar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t reach = 1;
    double rest_m = 0.0;  ///< length at rest
};

/// Three particles of a rope that resists bending, `b` between the others: the energy
/// stiffness_n_m * (1 - cos(angle)), the angle being that between the bars a-b and b-c, 0 where straight.
struct Bend {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t c = 0;
    double stiffness_n_m = 0.0;  ///< E I over the mean of the two bars' lengths at rest
};

/// All particles and bars of a scene at t = 0, whatever they come from. Arrays have one entry a particle.
///
/// Positions are relative to `origin_m`, the first body's own origin: the same scene far from (0, 0) is
/// solved with the same bits.
struct System {
    Vec2 origin_m;
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> vx_m_s;  ///< 0 for a pinned particle
    std::vector<double> vy_m_s;
    std::vector<double> mass_kg;            ///< payload included
    std::vector<double> inverse_mass_1_kg;  ///< 0 means pinned
    std::vector<Bar>
        bars;  ///< in the order of relaxation: body by body, all of reach 1, then all of reach 2, ...
    std::vector<Bend> bends;   ///< empty unless a rope resists bending
    std::vector<Body> bodies;  ///< ropes, then nets

    [[nodiscard]] std::size_t particle_count() const { return x_m.size(); }
    [[nodiscard]] std::size_t link_count() const;
    [[nodiscard]] bool is_pinned(std::size_t particle) const { return inverse_mass_1_kg[particle] == 0.0; }
};

/// The bars that keep their lengths, in the system's order: those of bodies without compliance.
[[nodiscard]] std::vector<Bar> rigid_bars(const System& system);

/// Number of bars of a rope of `particles` with bars to the next 1..`reach`: the sum of (particles - k),
/// which for reach 7 is 7 n - 28. A closed rope has `particles` of each reach, and half as many of the one
/// that joins opposite particles.
[[nodiscard]] std::uint64_t bar_count(std::uint64_t particles, std::uint64_t reach, bool closed = false);

/// Puts ropes and nets into one System. Requires what their Defs say of their fields; `reach` >= 1 counts for
/// ropes alone.
[[nodiscard]] System build_system(std::span<const RopeDef> ropes, std::span<const NetDef> nets, int reach);

/// The same for ropes alone.
[[nodiscard]] System build_system(std::span<const RopeDef> ropes, int reach);

}  // namespace corda::sim
