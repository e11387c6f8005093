#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "corda/sim/exact/chain_bending.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The motion of ropes of rigid links as a system of ordinary differential equations: sections 1 to 3 and 10
/// of src/corda/sim/exact/README.md.
///
/// A rope is cut at its pinned particles into chains that move independently. Link i of a chain leads from
/// particle i-1 to i along the unit vector (c_i, s_i) and turns with the angular velocity w_i. The tensions
/// solve a tridiagonal system.
///
/// A state has one array each of c, s and w over the links of all chains, then, for every chain without a
/// pin, the place of its centre of mass, relative to where its first particle starts, and its velocity (x, y,
/// vx, vy). It does not depend on where the rope is. A chain with one pin starts at it.
class ChainDynamics : public Dynamics {
  public:
    /// A chain between two pins, a pin and a free end, or two free ends; or one free particle without a link.
    struct Chain {
        std::size_t first_link = 0;
        std::size_t link_count = 0;
        std::size_t first_particle = 0;  ///< start of link 0
        bool runs_backwards = false;     ///< towards lower indices of particles
        bool starts_pinned = true;
        bool ends_pinned = false;
        std::size_t first_extra = 0;     ///< index of x, y, vx, vy in a state, if the start is not pinned
        Vec2 start_m;                    ///< of the first particle
        Vec2 span_m;                     ///< from the first particle to the last at t = 0
        double inverse_mass_1_kg = 0.0;  ///< of the first particle
        double length_m = 0.0;
        double inverse_timescale_1_s = 0.0;  ///< see Forces::inverse_timescale_1_s
        /// The particle at the far end of a link; links are counted from the chain's first one.
        [[nodiscard]] std::size_t particle(std::size_t link) const {
            return runs_backwards ? first_particle - link - 1 : first_particle + link + 1;
        }
    };

    /// `bodies`: chains of the system or parts of chains. Throws corda::Refusal for a rope that is taut
    /// between two pins.
    ChainDynamics(const System& system, std::span<const Body> bodies, const Forces& forces);

    /// Throws corda::Refusal if a chain of this length between two pins, the particles `from` and `to` at a
    /// distance of `span_m`, is taut.
    static void refuse_taut(double length_m, Vec2 span_m, std::size_t from, std::size_t to);

    /// Initial velocities that would change the length of a link are removed by the impulses that rigid links
    /// would exert.
    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }

    /// Directions are measured by themselves, positions by the chain's length, angular velocities by the
    /// inverse of its time scale and by themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;

    [[nodiscard]] double inverse_timescale_1_s() const override;

    void derivative(const double* y, double* slope) override;

    /// Makes directions unit vectors and closes chains between two pins.
    void project(double* y) override;

    void positions(const double* y, State& state) const override;

    void velocities(const double* y, std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) const override;

    [[nodiscard]] double energy_j(const double* y) const override;

    /// Entry i belongs to the link between particle i of the system and the next one; 0 without a link.
    void tensions(const double* y, std::vector<double>& tension_n) override;

    /// Brings the end of a chain between two pins back to its pin, and the end's velocity to 0, by the least
    /// changes of the links' directions and angular velocities.
    void close(const Chain& chain, double* y) const;

    /// 0 if all links of a chain are in one line, where they do not determine the tensions between two pins;
    /// grows with the square of the angles from it, up to 1/4.
    [[nodiscard]] double spread(const Chain& chain, const double* y) const;

    [[nodiscard]] std::size_t link_count() const { return length_m_.size(); }
    [[nodiscard]] const std::vector<Chain>& chains() const { return chains_; }
    [[nodiscard]] const Forces& forces() const { return forces_; }
    [[nodiscard]] double length_m(std::size_t link) const { return length_m_[link]; }
    /// Of the particle at the link's far end; 0 if pinned.
    [[nodiscard]] double inverse_mass_1_kg(std::size_t link) const { return inverse_mass_1_kg_[link]; }

    /// The link that joins a particle of the system to the next one.
    [[nodiscard]] const ChainLink& link(std::size_t particle) const { return links_[particle]; }

  protected:
    /// Adds a free particle of the system, with its x, y, vx and vy at the end of a state. Errors of its
    /// position are measured by `length_m`, those of its velocity by that times `inverse_timescale_1_s`.
    void add_particle(const System& system, std::size_t particle, double length_m,
                      double inverse_timescale_1_s);

  private:
    struct Pin {
        std::size_t particle = 0;
        Vec2 position_m;
    };

    void add_body(const System& system, const Body& body);
    void add_chain(const System& system, const Body& body, std::size_t from, std::size_t to);
    void add_initial_velocities(const System& system, const Chain& chain, double* y);
    /// Requires the directions and the angular velocities.
    void add_center_of_mass(const System& system, const Chain& chain, double* y);
    void set_timescales();
    // kBends: with the couples of bending, which have been found; a parameter, so that loops have no branch.
    template <bool kBends>
    void evaluate(const double* y, double* slope);
    /// Writes the angular accelerations of a chain's links, without bending.
    void turn(const Chain& chain, const double* y, double* slope_omega) const;
    template <bool kBends>
    void find_tensions(const Chain& chain, const double* y);
    void find_all_tensions(const double* y);
    [[nodiscard]] bool bends() const { return !bending_.empty(); }
    void measure_joints(const Chain& chain, const double* y);
    void measure_loads(const Chain& chain, const double* y);
    void solve_tensions(const Chain& chain);
    [[nodiscard]] double pull_across(const Chain& chain, std::size_t link) const;
    void add_bending_along(const Chain& chain);
    void add_bending_across(const Chain& chain, double* slope) const;
    /// Calls visit(particle, displacement from the chain's start, velocity) for each free particle of a
    /// chain.
    template <class Visit>
    void walk(const Chain& chain, const double* y, const Visit& visit) const;

    Forces forces_;
    std::vector<double> mass_kg_;  ///< one per particle of the system; 0 if pinned
    std::vector<Pin> pins_;
    std::vector<Chain> chains_;
    ChainBending bending_;
    std::vector<ChainLink> links_;  ///< one per particle of the system
    std::vector<double> initial_state_;
    std::size_t extra_count_ = 0;
    double energy_offset_j_ = 0.0;  ///< potential energy of all masses at their chains' first particles

    // One entry per link from here on.
    std::vector<double> length_m_;
    std::vector<double> inverse_length_1_m_;
    std::vector<double> inverse_mass_1_kg_;  ///< of the particle at the link's far end
    std::vector<double> beyond_;             ///< share of a free chain's mass that is beyond the link
    // Scratch of an evaluation.
    std::vector<double> cosine_;  ///< W_i C_i
    std::vector<double> sine_;    ///< W_i S_i
    std::vector<double> along_;   ///< right-hand side of the tensions
    std::vector<double> pivot_;   ///< W_{i-1} Q_i + P_i: Q_i times the pivot of link i
    std::vector<double> weight_;  ///< Q_i, then the factor of T_{i-1} in T_i
    std::vector<double> tension_n_;
};

}  // namespace corda::sim
