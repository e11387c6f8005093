#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// A rope or a net: its share of the particles and bars of a System.
struct Body {
    std::size_t first_particle = 0;
    std::size_t particle_count = 0;
    std::size_t first_bar = 0;
    std::size_t bar_count = 0;   ///< real and imaginary
    std::size_t link_count = 0;  ///< real bars; they come first
    bool is_chain = true;        ///< link k joins particles k and k + 1, and there are no other links
    bool is_net = false;         ///< made from a NetDef
    double payload_kg = 0.0;     ///< share of the last particle's mass
    MaterialDef material;
};

/// Two particles held at a distance. A bar of reach 1 is real, a link of a rope; a bar of longer reach is
/// imaginary: it stiffens the rope or the net and is not part of it.
struct Bar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t reach = 1;
    double rest_m = 0.0;  ///< rest length
};

/// Three particles of a rope that resists bending, `b` between the others. Its energy is
/// stiffness_n_m * (1 - cos(angle)) with the angle between the bars a-b and b-c, 0 if they are straight.
struct Bend {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t c = 0;
    double stiffness_n_m = 0.0;  ///< E I over the mean of the two bars' rest lengths
};

/// All particles and bars of a scene at t = 0. Arrays have one entry per particle.
///
/// Positions are relative to `origin_m`, the first body's own origin, so that a scene far from (0, 0) is
/// solved with the same bits.
struct System {
    Vec2 origin_m;
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> vx_m_s;  ///< 0 for a pinned particle
    std::vector<double> vy_m_s;
    std::vector<double> mass_kg;            ///< payload included
    std::vector<double> inverse_mass_1_kg;  ///< 0 means pinned
    /// In the order of relaxation: body by body, all bars of reach 1, then all of reach 2, ...
    std::vector<Bar> bars;
    std::vector<Bend> bends;   ///< empty unless a rope resists bending
    std::vector<Body> bodies;  ///< ropes, then nets

    [[nodiscard]] std::size_t particle_count() const { return x_m.size(); }
    [[nodiscard]] std::size_t link_count() const;
    [[nodiscard]] bool is_pinned(std::size_t particle) const { return inverse_mass_1_kg[particle] == 0.0; }
};

/// Some consecutive links of a rope.
struct LinkRange {
    std::size_t begin = 0;
    std::size_t end = 0;

    [[nodiscard]] bool contains(std::size_t k) const { return begin <= k && k < end; }
};

/// The links between the outermost pinned particles of a rope; all links of a closed one.
[[nodiscard]] LinkRange links_between_pins(const RopeDef& rope);

/// The rope as it starts if that is not as given; std::nullopt for most. A string without compliance cannot
/// span more than its rest lengths: a link that is given a larger distance starts taut, in the same
/// direction, and the particles beyond it, seen from the pins (from the first particle if there are none),
/// move along. Distances between pins stay as they are.
[[nodiscard]] std::optional<RopeDef> pulled_in(const RopeDef& given);

/// Sum of the rest lengths of a body's links, in m.
[[nodiscard]] double links_length_m(const System& system, const Body& body);

/// The largest of these sums.
[[nodiscard]] double largest_length_m(const System& system);

/// How many of its bodies are ropes: they come before the nets.
[[nodiscard]] std::size_t rope_count(const System& system);

/// "rope 2" or "net 0": what a body of the system is called, its number among its kind.
[[nodiscard]] std::string body_name(const System& system, std::size_t body);

/// The bars of bodies without compliance, in the system's order.
[[nodiscard]] std::vector<Bar> rigid_bars(const System& system);

/// Number of bars of a rope of n particles that joins each to the next 1 .. `reach`: the sum of (n - k),
/// which for reach 7 is 7 n - 28. A closed rope has n bars of each reach, but n / 2 of the reach that joins
/// opposite particles.
[[nodiscard]] std::uint64_t bar_count(std::uint64_t particles, std::uint64_t reach, bool closed = false);

/// Puts ropes and nets, at least one of them, into one System. Throws corda::Error (kInvalidScene) for a
/// field that is not what its declaration says.
[[nodiscard]] System build_system(std::span<const RopeDef> ropes, std::span<const NetDef> nets = {});

/// Positions of all particles at one time, relative to the system's origin.
struct State {
    double time_s = 0.0;
    std::vector<double> x_m;
    std::vector<double> y_m;
    // Empty unless they are asked for: see Readings.
    std::vector<double> vx_m_s = {};  ///< 0 for a pinned particle
    std::vector<double> vy_m_s = {};
    /// One per bar of the system: positive ones pull. 0 between two pins; NaN if it is not determined.
    std::vector<double> tension_n = {};
};

/// A quantity of a link: its tension in N, the mean of the speeds of its ends in m/s, or its length over its
/// rest length - 1, which for a slack link of a string is 0.
enum class Quantity { kTension, kSpeed, kStrain };

/// What states have besides positions.
struct StateFields {
    bool velocities = false;
    bool tensions = false;
    /// Tensions that a method does not know are NaN; otherwise asking for them is an error.
    bool unknown_tensions = false;

    /// What either has.
    [[nodiscard]] StateFields with(const StateFields& other) const {
        const bool are_needed =
            (tensions && !unknown_tensions) || (other.tensions && !other.unknown_tensions);
        return {velocities || other.velocities, tensions || other.tensions,
                !are_needed && (unknown_tensions || other.unknown_tensions)};
    }
    friend bool operator==(const StateFields&, const StateFields&) = default;
};

/// Whether a run can go on. A run that diverged keeps the last good state.
enum class [[nodiscard]] Status{kOk, kDiverged};

/// What the links carry at one time.
struct Loads {
    double pin_force_n = 0.0;  ///< largest force that links exert on a pinned particle
    /// Largest tension of a link. A link that pushes counts by the size of its tension.
    double largest_tension_n = 0.0;
};

}  // namespace corda
#pragma GCC visibility pop
