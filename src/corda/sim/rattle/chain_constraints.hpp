#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/rattle/constraint_solver.hpp"

namespace corda::sim {

/// Bars along chains, which end at the ends of a rope and at pinned particles. Newton's matrix is
/// tridiagonal. The squared lengths are quadratic in the impulses, so the error that a Newton step leaves is
/// exactly | span du |^2, du being the change of the bar's relative velocity.
class ChainConstraints final : public ConstraintSolver {
  public:
    /// True if all of these bars join a particle i to particle i + 1, in ascending order. True if there are
    /// none.
    [[nodiscard]] static bool suits(std::span<const Bar> bars);

    /// Requires rigid bars that suit. Throws corda::Refusal for a chain that is straight between two pins.
    explicit ChainConstraints(const System& system);

    [[nodiscard]] bool move(const Stage& stage, Motion& motion, std::span<double> impulse) override;
    [[nodiscard]] bool solve(const Motion& motion, std::span<double> right) override;
    [[nodiscard]] double square_frequency(std::span<const double> multiplier) const override;
    [[nodiscard]] std::vector<double> carried_mass(std::span<const double> mass_kg) const override;
    [[nodiscard]] const RigidBars& bars() const override { return bars_; }

  private:
    /// Links first_link .. first_link + count - 1 join particles first_particle .. first_particle + count.
    struct Chain {
        std::size_t first_particle = 0;
        std::size_t first_link = 0;
        std::size_t count = 0;
    };
    void refuse_straight_between_pins(const System& system) const;
    void bar_vectors(const Chain& chain, const Motion& motion);
    void assemble(const Chain& chain, double span_s, const Motion& motion);
    [[nodiscard]] bool apply(const Chain& chain, double span_s, const double* impulse, Motion& motion);
    void add_total(const Chain& chain, Motion& motion) const;
    [[nodiscard]] bool meet_lengths(const Chain& chain, double span_s, Motion& motion, double* impulse);

    RigidBars bars_;
    std::vector<Chain> chains_;
    std::vector<double> square_m2_;  ///< one per link: its rest length squared
    // Scratch for one chain. Entry k + 1 belongs to link k; the first and the last entry stand for bars that
    // do not exist and are 0.
    std::vector<double> dx_m_;  ///< bar vectors at the start of the stage
    std::vector<double> dy_m_;
    std::vector<double> lower_;
    std::vector<double> diagonal_;
    std::vector<double> upper_;
    std::vector<double> right_;
    // Scratch for one chain, one entry per particle: velocities before the impulses, changes by all impulses
    // together and by the last ones.
    std::vector<double> start_x_m_s_;
    std::vector<double> start_y_m_s_;
    std::vector<double> total_x_m_s_;
    std::vector<double> total_y_m_s_;
    std::vector<double> change_x_m_s_;
    std::vector<double> change_y_m_s_;
};

}  // namespace corda::sim
