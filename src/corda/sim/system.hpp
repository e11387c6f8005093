#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
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
    std::string label = {};  ///< its name in texts; empty: see body_name()
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
    double cut_s = std::numeric_limits<double>::infinity();  ///< when one of the two is cut
};

/// All particles and bars of a scene at its start. Arrays have one entry per particle.
///
/// Positions are relative to `origin_m`, the first body's own origin, so that a scene far from (0, 0) is
/// solved with the same bits.
struct System {
    Vec2 origin_m;
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> vx_m_s;  ///< of a pinned particle as well: 0 unless it moves
    std::vector<double> vy_m_s;
    std::vector<double> mass_kg;            ///< payload included
    std::vector<double> inverse_mass_1_kg;  ///< 0 means pinned
    /// In the order of relaxation: body by body, all bars of reach 1, then all of reach 2, ...
    std::vector<Bar> bars;
    std::vector<Bend> bends;             ///< empty unless a rope resists bending
    std::vector<Body> bodies;            ///< ropes, then nets
    std::vector<MoveDef> moves = {};     ///< of pinned particles of the system
    std::vector<double> release_s = {};  ///< per particle, when it is let go; empty: none is
    std::vector<double> cut_s = {};      ///< per bar, when it is gone; empty: none is
    double start_s = 0.0;                ///< the time of this state, from which a solver counts its own

    [[nodiscard]] std::size_t particle_count() const { return x_m.size(); }
    [[nodiscard]] std::size_t link_count() const;
    /// At the start.
    [[nodiscard]] bool is_pinned(std::size_t particle) const { return inverse_mass_1_kg[particle] == 0.0; }

    /// Pins are let go or bars cut.
    [[nodiscard]] bool has_events() const { return !release_s.empty() || !cut_s.empty(); }
    /// What is let go or cut is free or gone at that very time.
    [[nodiscard]] bool is_pinned_at(std::size_t particle, double time_s) const {
        return is_pinned(particle) && (release_s.empty() || time_s < release_s[particle]);
    }
    [[nodiscard]] bool has_bar_at(std::size_t bar, double time_s) const {
        return cut_s.empty() || time_s < cut_s[bar];
    }
    /// Pinned, and never let go.
    [[nodiscard]] bool stays_pinned(std::size_t particle) const {
        return is_pinned_at(particle, std::numeric_limits<double>::max());
    }
};

/// A range of consecutive links of a rope.
struct LinkRange {
    std::size_t begin = 0;
    std::size_t end = 0;

    [[nodiscard]] bool contains(std::size_t k) const { return begin <= k && k < end; }
};

/// The links between the outermost pinned particles of a rope; all links of a closed one.
[[nodiscard]] LinkRange links_between_pins(const RopeDef& rope);

/// The rope's actual start if it differs from the given points; std::nullopt for most ropes. A string without
/// compliance cannot span more than its rest lengths: a link longer than its rest length starts taut in the
/// same direction, and the particles beyond it, seen from the pins (from the first particle without pins),
/// are shifted along. Distances between pins stay.
[[nodiscard]] std::optional<RopeDef> pulled_in(const RopeDef& given);

/// Sum of the rest lengths of a body's links, in m.
[[nodiscard]] double links_length_m(const System& system, const Body& body);

/// The largest of these sums.
[[nodiscard]] double largest_length_m(const System& system);

/// Ratio of the masses of a body's heaviest and lightest free particle; 1 if none is free.
[[nodiscard]] double mass_ratio(const System& system, const Body& body);

/// Number of ropes among the bodies; ropes come before nets.
[[nodiscard]] std::size_t rope_count(const System& system);

/// Index of the body that has a particle.
[[nodiscard]] std::size_t body_of(const System& system, std::size_t particle);

/// Name of a body: "rope 2" or "net 0", counted within its kind.
[[nodiscard]] std::string body_name(const System& system, std::size_t body);

/// The names of all bodies for columns of tables, distinct: "rope_2", "8_kg", "8_kg_2".
[[nodiscard]] std::vector<std::string> body_keys(const System& system);

/// The bars of bodies without compliance, in the system's order.
[[nodiscard]] std::vector<Bar> rigid_bars(const System& system);

/// Number of bars of a rope of n particles that joins each to the next 1 .. `reach`: the sum of (n - k),
/// which for reach 7 is 7 n - 28. A closed rope has n bars of each reach, but n / 2 of the reach that joins
/// opposite particles.
[[nodiscard]] std::uint64_t bar_count(std::uint64_t particles, std::uint64_t reach, bool closed = false);

/// Builds the System of some ropes and nets, at least one body. Throws corda::Error (kInvalidScene) for a
/// field outside the range of its declaration.
[[nodiscard]] System build_system(std::span<const RopeDef> ropes, std::span<const NetDef> nets = {});

/// Positions of all particles at one time, relative to the system's origin.
struct State {
    double time_s = 0.0;
    std::vector<double> x_m;
    std::vector<double> y_m;
    // Empty unless requested: see StateFields.
    std::vector<double> vx_m_s = {};  ///< 0 for a pinned particle that does not move
    std::vector<double> vy_m_s = {};
    /// One per bar of the system: positive ones pull. 0 between two pins; NaN if it is not determined.
    std::vector<double> tension_n = {};
};

/// A quantity of a link: its tension in N, the mean of the speeds of its ends in m/s, or its length over its
/// rest length - 1, which for a slack link of a string is 0.
enum class Quantity { kTension, kSpeed, kStrain };

/// The data in a state besides positions.
struct StateFields {
    bool velocities = false;
    bool tensions = false;
    /// Tensions that a method does not know are NaN; otherwise asking for them is an error.
    bool unknown_tensions = false;

    /// The union of both.
    [[nodiscard]] StateFields with(const StateFields& other) const {
        const bool are_needed =
            (tensions && !unknown_tensions) || (other.tensions && !other.unknown_tensions);
        return {velocities || other.velocities, tensions || other.tensions,
                !are_needed && (unknown_tensions || other.unknown_tensions)};
    }
    friend bool operator==(const StateFields&, const StateFields&) = default;
};

/// Outcome of a run so far. A diverged run keeps its last good state.
enum class [[nodiscard]] Status{kOk, kDiverged};

/// Loads on pins and links at one time.
struct Loads {
    double pin_force_n = 0.0;  ///< largest force of the links on a pinned particle
    /// Largest absolute tension of a link.
    double largest_tension_n = 0.0;
};

}  // namespace corda
#pragma GCC visibility pop

namespace corda {

/// Thrown by `sim` for a definition with a field outside its range and for a system that a method cannot
/// run: an Error of code kInvalidScene. The message gives the physical reason; film adds the name of the
/// scene and, chosen by `reason()`, the keys of the scene file that would help.
class Refusal : public Error {
  public:
    enum class Reason {
        kDefinition,          ///< a field is not what its declaration says
        kBarWithoutLength,    ///< all but `relaxation`: a bar whose particles coincide
        kImaginaryBars,       ///< `exact`: bars of reach > 1
        kRigidGraph,          ///< `exact`: a closed rope of rigid links that resists bending
        kRigidStringGraph,    ///< `exact`: a string of rigid links that does not form an open chain
        kRigidString,         ///< `rattle`: a string of rigid links
        kRigidBendingString,  ///< `exact`: a string of rigid links that resists bending
        kStretchedString,     ///< `exact`: a rigid link of a string longer at the start than its rest length
        kUndecidedString,     ///< `exact`: the start does not determine which links of a string are taut
        kUnlikeMoves,         ///< pins of one body move differently
        kTautBetweenPins,     ///< a rigid rope that is straight between two pins
        kImplicit,            ///< `exact`, implicit: see ImplicitPart::can_move
        kDependentBars,       ///< `rattle`: the lengths of rigid bars depend on each other
        kMaterial,            ///< `relaxation`: compliance, a string or bending
        kUnknownTensions,     ///< tensions are requested that the method does not know
        kManySteps,           ///< `auto`: the motion takes too many steps of every method
    };

    Refusal(Reason reason, const std::string& problem)
        : Error(ExitCode::kInvalidScene, problem), reason_(reason) {}

    [[nodiscard]] Reason reason() const noexcept { return reason_; }

  private:
    Reason reason_;
};

/// The smallest upright box that contains all positions of a motion, in metres relative to the system's
/// origin. Empty at first.
class MotionBounds {
  public:
    void include(double x_m, double y_m) {
        min_ = {std::min(min_.x, x_m), std::min(min_.y, y_m)};
        max_ = {std::max(max_.x, x_m), std::max(max_.y, y_m)};
    }
    void include(const State& state) {
        for (std::size_t i = 0; i < state.x_m.size(); ++i) include(state.x_m[i], state.y_m[i]);
    }
    void include(const MotionBounds& other) {
        min_ = {std::min(min_.x, other.min_.x), std::min(min_.y, other.min_.y)};
        max_ = {std::max(max_.x, other.max_.x), std::max(max_.y, other.max_.y)};
    }
    [[nodiscard]] bool empty() const { return max_.x < min_.x; }
    /// With `more_m` more on each side.
    [[nodiscard]] MotionBounds widened(double more_m) const {
        MotionBounds wide = *this;
        if (more_m > 0.0 && !empty()) {
            wide.include(min_.x - more_m, min_.y - more_m);
            wide.include(max_.x + more_m, max_.y + more_m);
        }
        return wide;
    }
    [[nodiscard]] Vec2 min_m() const { return min_; }
    [[nodiscard]] Vec2 max_m() const { return max_; }

  private:
    Vec2 min_{1e300, 1e300};
    Vec2 max_{-1e300, -1e300};
};

/// Bounds of each particle at the start.
[[nodiscard]] inline std::vector<MotionBounds> bounds_of_start(const System& system) {
    std::vector<MotionBounds> bounds(system.particle_count());
    for (std::size_t i = 0; i < bounds.size(); ++i) bounds[i].include(system.x_m[i], system.y_m[i]);
    return bounds;
}

/// Of all particles together.
[[nodiscard]] inline MotionBounds whole_bounds_of_start(const System& system) {
    MotionBounds start;
    start.include({0.0, system.x_m, system.y_m});
    return start;
}

}  // namespace corda

namespace corda::sim {

/// Number of pinned particles of a body.
[[nodiscard]] std::size_t pin_count(const System& system, const Body& body);

/// True for a rope that is open, or of rigid links, closed and held by a pin: then it is a chain from that
/// pin round to it again. A closed one of three or four links may move as a NetModel, and does not count.
[[nodiscard]] bool moves_as_chains(const System& system, const Body& body);

/// Calls `use` for each body in order, with a System of that body alone and the body's index. This System
/// keeps the origin, counts particles and bars from 0 and lives only for the call. If there are several
/// bodies, the message of a corda::Refusal from `use` is prefixed with the body's name.
void for_each_body(const System& system, const std::function<void(const System&, std::size_t)>& use);

}  // namespace corda::sim
