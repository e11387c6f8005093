#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The link of a ChainDynamics that joins a particle to the next one.
struct ChainLink {
    std::size_t index = 0;
    bool runs_backwards = false;  ///< it leads from the next particle to this one
    bool moves = false;           ///< false: between two pins, or in no chain
};

/// The couples by which the links of a ChainDynamics resist bending, in that class's notation.
///
/// A bend of stiffness k between links i and j has the energy k (1 - o u_i . u_j), where o is -1 if exactly
/// one of the two leads against the order of the rope's particles, and 1 otherwise. It turns link i by the
/// torque k o p_i . u_j and link j by k o p_j . u_i. The torques on a link together are a couple of forces:
/// q_i p_i at its far particle and -q_i p_i at its near one. If all bends lie inside a chain,
///
///   q_i = (k_i S_i - k_{i-1} S_{i-1}) / a_i,   S_i = u_i x u_{i+1},   k_i between links i and i+1.
class ChainBending {
  public:
    /// No bends.
    ChainBending() = default;

    /// The bends of `system` in which a link moves. `links` has one entry per particle, `length_m` one per
    /// link of the state.
    ChainBending(const System& system, const std::vector<ChainLink>& links,
                 const std::vector<double>& length_m);

    /// True if there are no bends.
    [[nodiscard]] bool empty() const { return couple_n_.empty(); }

    /// Computes couple_n() in a state of the ChainDynamics.
    void find_couples(const double* y);

    /// q_i of every link, in newtons.
    [[nodiscard]] const std::vector<double>& couple_n() const { return couple_n_; }

    [[nodiscard]] double energy_j(const double* y) const;

    /// The bending stiffness E I in N m^2 at a link: the larger of those at its two ends.
    [[nodiscard]] double rigidity_n_m2(std::size_t link) const { return rigidity_n_m2_[link]; }

  private:
    /// A bend at a pin between two links that move.
    struct Joint {
        std::size_t a = 0;
        std::size_t b = 0;
        double stiffness_n_m = 0.0;  ///< with the sign o
    };
    /// A bend between a link that moves and a link between two pins.
    struct Clamp {
        std::size_t link = 0;        ///< index of the moving link
        Vec2 along;                  ///< unit vector of the fixed link, in the order of the rope
        double stiffness_n_m = 0.0;  ///< with the sign o
    };

    void add_bend(const System& system, const Bend& bend, const ChainLink& before, const ChainLink& after,
                  const std::vector<double>& length_m);

    // One entry per link.
    std::vector<double> inverse_length_1_m_;
    std::vector<double> stiffness_n_m_;  ///< k_i, 0 for the last link of a chain
    std::vector<double> rigidity_n_m2_;
    std::vector<double> couple_n_;

    std::vector<Joint> joints_;
    std::vector<Clamp> clamps_;
};

}  // namespace corda::sim
