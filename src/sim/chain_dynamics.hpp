#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "corda/sim/chain_bending.hpp"
#include "corda/sim/dynamics.hpp"
#include "corda/sim/system.hpp"
#include "corda/sim/terms.hpp"

namespace corda::sim {

/// The motion of ropes of rigid links as a system of ordinary differential equations.
///
/// A rope is cut at its pinned particles into chains that move apart from each other. Link i of a chain leads
/// from particle i-1 to i along the unit vector u_i = (c_i, s_i) and turns at the rate w_i. With
/// p_i = (-s_i, c_i),
///
///   u_i' = w_i p_i,   x_k = x_0 + sum over i <= k of a_i u_i,
///
/// so a link keeps its length a_i whatever the tensions are. Newton's law for a particle of inverse mass W_k
/// (0 where pinned), the tensions T_i and the drag c is
///
///   x_k'' = g_k + W_k (T_{k+1} u_{k+1} - T_k u_k) - c x_k',   g_k = g, or 0 for a pinned particle.
///
/// The difference of two neighbours is a_i u_i'' = a_i (w_i' p_i - w_i^2 u_i). Along u_i the drag drops out
/// and a tridiagonal system for the tensions remains, in which C_i = u_i . u_{i+1}:
///
///   (W_{i-1} + W_i) T_i - W_{i-1} C_{i-1} T_{i-1} - W_i C_i T_{i+1} = a_i w_i^2 + (g_i - g_{i-1}) . u_i.
///
/// Along p_i the turning follows, in which S_i = u_i x u_{i+1}:
///
///   a_i w_i' = (g_i - g_{i-1}) . p_i + W_i S_i T_{i+1} - W_{i-1} S_{i-1} T_{i-1} - c a_i w_i.
///
/// A state has one array each of c, s and w over the links of all chains, then, for every chain that has no
/// pin, the displacement of its first particle from the start and its velocity (x, y, vx, vy). Nothing in it
/// depends on where a rope stands. Chains with one pin start at it.
///
/// The elimination runs from the last link to the first. Its pivots are W_{i-1} + e_i, where 1 / e_i is the
/// mass that the chain beyond link i shows to a pull along it. Written as a fraction e_i = P_i / Q_i,
///
///   Q_i = P_{i+1} + W_i Q_{i+1},   P_i = W_i P_{i+1} + (W_i S_i)^2 Q_{i+1},   P_n = W_n, Q_n = 1,
///
/// nothing but positive numbers are added: no digit is lost however unequal the masses are, and the only
/// divisions, by W_{i-1} Q_i + P_i, do not wait for each other.
///
/// A rope that resists bending puts a couple on every link, q_i p_i at its far particle and -q_i p_i at its
/// near one (ChainBending says how large it is). With p_{i+1} . u_i = -S_i and p_{i+1} . p_i = C_i, the right
/// sides of the two equations gain
///
///   along u_i:  W_i S_i q_{i+1} - W_{i-1} S_{i-1} q_{i-1},
///   along p_i:  (W_{i-1} + W_i) q_i - W_i C_i q_{i+1} - W_{i-1} C_{i-1} q_{i-1},
///
/// and the energy the sum over all bends of k (1 - cos(angle)).
class ChainDynamics final : public Dynamics {
  public:
    /// A chain between two pins, a pin and a free end, or two free ends.
    struct Chain {
        std::size_t first_link = 0;
        std::size_t link_count = 0;
        std::size_t first_particle = 0;  ///< the one that link 0 starts at
        bool runs_backwards = false;     ///< towards lower indices of particles
        bool starts_pinned = true;
        bool ends_pinned = false;
        std::size_t start_pin = 0;       ///< among pins_, where the start is pinned
        std::size_t end_pin = 0;         ///< where the end is
        std::size_t first_extra = 0;     ///< of x, y, vx, vy in a state, where the start is not pinned
        Vec2 start_m;                    ///< of the first particle
        Vec2 span_m;                     ///< from the first particle to the last at t = 0
        double inverse_mass_1_kg = 0.0;  ///< of the first particle
        double length_m = 0.0;
        double rate_1_s = 0.0;  ///< how fast it moves by about its own length
        /// The particle at the far end of a link counted from the chain's first.
        [[nodiscard]] std::size_t particle(std::size_t link) const {
            return runs_backwards ? first_particle - link - 1 : first_particle + link + 1;
        }
    };

    /// Of `bodies`, chains of the system or parts of chains; the others are left alone. Throws corda::Error
    /// for a rope that leaves no room to move between two pins.
    ChainDynamics(const System& system, std::span<const Body> bodies, const WorldDef& world);

    /// Throws corda::Error where a chain between two pins, particles `from` and `to` and `span_m` apart, is
    /// too short to move.
    static void refuse_taut(double length_m, Vec2 span_m, std::size_t from, std::size_t to);

    /// Velocities that would change the length of a link are taken out by the impulses that rigid links would
    /// exert.
    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }

    /// How errors in a state are measured: directions by themselves, positions by the rope's length, rates by
    /// the rope's own rate and themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;

    /// The inverse of the shortest time in which a rope moves by about its own length, 1/s; > 0.
    [[nodiscard]] double largest_rate_1_s() const override;

    void derivative(const double* y, double* slope) override;

    /// Makes directions unit vectors, closes chains between two pins (least change of the angles and rates)
    /// and sets what is too small to matter to zero.
    void settle(double* y) override;

    void positions(const double* y, State& state) const override;

    /// Writes the velocities of the particles that positions() writes, in m/s.
    void velocities(const double* y, std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) const;

    [[nodiscard]] double energy_j(const double* y) const override;
    [[nodiscard]] double energy_scale_j() const override { return energy_scale_j_; }
    [[nodiscard]] Loads loads(const double* y) override;

    /// Writes the tension of every link in the state's order; positive pulls.
    void tensions(const double* y, std::vector<double>& tension_n);

    /// Turns the links of a chain between two pins, and their rates, by the least that closes it.
    void close(const Chain& chain, double* y) const;

    [[nodiscard]] std::size_t link_count() const { return length_m_.size(); }
    [[nodiscard]] const std::vector<Chain>& chains() const { return chains_; }
    [[nodiscard]] Vec2 gravity_m_s2() const { return gravity_m_s2_; }
    [[nodiscard]] double drag_1_s() const { return drag_1_s_; }
    [[nodiscard]] double length_m(std::size_t link) const { return length_m_[link]; }
    /// Of the particle at the link's far end; 0 where pinned.
    [[nodiscard]] double inverse_mass_1_kg(std::size_t link) const { return inverse_mass_1_kg_[link]; }

    /// The link between a particle of the system and the next one.
    [[nodiscard]] const ChainLink& link(std::size_t particle) const { return links_[particle]; }

  private:
    struct Pin {
        std::size_t particle = 0;
        Vec2 position_m;
        Vec2 force_n;  ///< worked out by loads()
    };

    void add_body(const System& system, const Body& body);
    void add_chain(const System& system, const Body& body, std::size_t from, std::size_t to);
    void add_initial_velocities(const System& system, const Chain& chain, double* y);
    void set_rates();
    /// With couples of bending that have been found, or without any: the branch stands outside of all loops.
    template <bool kBends>
    void evaluate(const double* y, double* slope);
    template <bool kBends>
    void find_tensions(const Chain& chain, const double* y);
    void find_all_tensions(const double* y);
    [[nodiscard]] bool bends() const { return kTermsCompiledIn && !bending_.empty(); }
    void measure_turns(const Chain& chain, const double* y);
    void measure_loads(const Chain& chain, const double* y);
    void solve_tensions(const Chain& chain);
    [[nodiscard]] double pull_across(const Chain& chain, std::size_t link) const;
    void add_bending_along(const Chain& chain);
    void add_bending_across(const Chain& chain, const double* y, double* slope) const;
    void add_clamp_forces();

    Vec2 gravity_m_s2_;
    double drag_1_s_;
    std::vector<double> mass_kg_;  ///< a particle; 0 where pinned
    std::vector<Pin> pins_;
    std::vector<Chain> chains_;
    ChainBending bending_;
    std::vector<ChainLink> links_;  ///< one a particle of the system
    std::vector<double> initial_state_;
    std::size_t extra_count_ = 0;
    double energy_scale_j_ = 0.0;
    double energy_offset_j_ = 0.0;  ///< potential energy of all masses at their chains' first particles

    // One entry a link from here on.
    std::vector<double> length_m_;
    std::vector<double> inverse_length_1_m_;
    std::vector<double> inverse_mass_1_kg_;  ///< of the particle at the link's far end
    // What an evaluation works with.
    std::vector<double> cosine_;  ///< W_i C_i
    std::vector<double> sine_;    ///< W_i S_i
    std::vector<double> along_;   ///< right-hand side of the tensions
    std::vector<double> pivot_;   ///< W_{i-1} Q_i + P_i
    std::vector<double> weight_;  ///< Q_i, then the factor of T_{i-1} in T_i
    std::vector<double> tension_n_;
};

}  // namespace corda::sim
