#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "corda/sim/exact/chain_bending.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/forces/time_function.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// A chain between two pins, a pin and a free end, or two free ends; or one free particle without a link.
/// Link i leads from particle i-1 to i along the unit vector (c_i, s_i) and turns with the angular velocity
/// w_i.
struct Chain {
    std::size_t first_link = 0;
    std::size_t link_count = 0;
    std::size_t first_particle = 0;  ///< start of link 0
    bool runs_backwards = false;     ///< towards lower indices of particles
    std::size_t ring = 0;  ///< number of particles of a closed rope; its particle 0 follows the last
    bool starts_pinned = true;
    bool ends_pinned = false;
    std::size_t start_pin = 0;  ///< index of Chains::pins, if the start is pinned
    std::size_t end_pin = 0;
    std::size_t first_extra = 0;     ///< index of x, y, vx, vy in a state, if the start is not pinned
    Vec2 start_m;                    ///< of the first particle
    Vec2 span_m;                     ///< from the first particle to the last at t = 0
    double inverse_mass_1_kg = 0.0;  ///< of the first particle
    double length_m = 0.0;
    double inverse_timescale_1_s = 0.0;  ///< see Forces::inverse_timescale_1_s
    /// The particle at the far end of a link, and the particle whose link to the next one it is; links are
    /// counted from the chain's first one.
    [[nodiscard]] std::size_t particle(std::size_t link) const {
        if (runs_backwards) return first_particle - link - 1;
        const std::size_t next = first_particle + link + 1;
        return ring > 0 && next >= ring ? next - ring : next;
    }
    [[nodiscard]] std::size_t lower_particle(std::size_t link) const {
        return runs_backwards ? particle(link) : link == 0 ? first_particle : particle(link - 1);
    }
};

/// Ropes cut at their pinned particles into chains that move independently: all that never changes.
///
/// A state has one array each of c, s and w over the links of all chains, then, for every chain without a
/// pin, the place of its centre of mass, relative to where its first particle starts, and its velocity (x, y,
/// vx, vy). It does not depend on where the rope is. A chain with one pin starts at it.
struct Chains {
    struct Pin {
        std::size_t particle = 0;
        Vec2 position_m;  ///< at t = 0
        TimeFunction displacement, velocity;
        Forces forces;  ///< on particles, seen from this pin
    };

    Forces forces;
    std::vector<Chain> list = {};
    std::vector<Pin> pins = {};
    bool are_of_ring = false;           ///< of a closed rope
    std::vector<double> mass_kg = {};   ///< one per particle of the system; 0 if pinned
    std::vector<ChainLink> links = {};  ///< from each particle of the system to the next
    ChainBending bending = {};
    double energy_offset_j = 0.0;  ///< potential energy of all masses at their chains' first particles
    double inverse_timescale_1_s = 1.0;
    /// The state at t = 0. Velocities that would change the length of a link are removed by the impulses that
    /// rigid links would exert.
    std::vector<double> start = {};

    // One entry per link.
    std::vector<double> length_m = {};
    std::vector<double> inverse_length_1_m = {};
    std::vector<double> inverse_mass_1_kg = {};  ///< of the particle at the link's far end; 0 if pinned
    std::vector<double> beyond = {};             ///< share of a free chain's mass that is beyond the link

    [[nodiscard]] std::size_t link_count() const { return length_m.size(); }
    /// The forces seen from the start of a chain, and from its end.
    [[nodiscard]] const Forces& forces_at_start(const Chain& chain) const {
        return chain.starts_pinned ? pins[chain.start_pin].forces : forces;
    }
    [[nodiscard]] const Forces& forces_at_end(const Chain& chain) const {
        return chain.ends_pinned ? pins[chain.end_pin].forces : forces;
    }
    /// Where the steps of a chain should end next after `time_s`; see Forces::next_key_s.
    [[nodiscard]] double next_key_s(const Chain& chain, double time_s) const {
        return std::min(forces_at_start(chain).next_key_s(time_s), forces_at_end(chain).next_key_s(time_s));
    }
};

/// The tensions of all chains in a state and what they follow from. One entry per link.
struct ChainTensions {
    explicit ChainTensions(std::size_t links)
        : cosine(links), sine(links), along(links), pivot(links), weight(links), tension_n(links) {}

    std::vector<double> cosine;  ///< W_i C_i
    std::vector<double> sine;    ///< W_i S_i
    std::vector<double> along;   ///< b_i, the right-hand side
    std::vector<double> pivot;   ///< W_{i-1} Q_i + P_i: Q_i times the pivot of link i
    std::vector<double> weight;  ///< Q_i, then the factor of T_{i-1} in T_i
    std::vector<double> tension_n;
};

/// `bodies`: chains of the system or parts of chains, or the one body, a closed rope. Throws corda::Refusal
/// for a rope of rigid links that is taut between two pins. Has no state at the start.
[[nodiscard]] Chains cut_at_pins(const System& system, std::span<const Body> bodies, const Forces& forces);

/// The same of rigid links, with the state at the start.
[[nodiscard]] Chains make_chains(const System& system, std::span<const Body> bodies, const Forces& forces);

/// Adds a free particle of the system as a chain without a link. Errors of its position are measured by
/// `length_m`, those of its velocity by that times the chains' inverse time scale.
void add_particle(Chains& chains, const System& system, std::size_t particle, double length_m);

/// The motion of chains of rigid links as a system of ordinary differential equations: sections 1 to 3 and 10
/// of src/corda/sim/exact/README.md. The tensions solve a tridiagonal system.
class ChainDynamics final : public Dynamics {
  public:
    explicit ChainDynamics(Chains chains);
    ChainDynamics(const System& system, std::span<const Body> bodies, const Forces& forces)
        : ChainDynamics(make_chains(system, bodies, forces)) {}

    [[nodiscard]] const Chains& chains() const { return chains_; }

    [[nodiscard]] const std::vector<double>& initial_state() const override { return chains_.start; }
    /// Directions are measured by themselves, positions by the chain's length, angular velocities by the
    /// inverse of its time scale and by themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;
    [[nodiscard]] double inverse_timescale_1_s() const override { return chains_.inverse_timescale_1_s; }
    void set_time(double time_s) override;
    [[nodiscard]] double next_key_s(double time_s) const override;
    void derivative(const double* y, double* slope) override;
    /// Makes directions unit vectors and closes chains between two pins.
    void project(double* y) override;
    void positions(const double* y, State& state) const override;
    void velocities(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    /// Entry i belongs to the link between particle i of the system and the next one, in a closed rope after
    /// the last the first; 0 without a link.
    void tensions(const double* y, std::vector<double>& tension_n) override;

  private:
    Chains chains_;
    double time_s_ = 0.0;
    ChainTensions scratch_;
};

}  // namespace corda::sim
