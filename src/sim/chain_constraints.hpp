#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/constraint_solver.hpp"

namespace corda::sim {

/// Bars that follow each other along chains. A chain ends where a rope ends and at every pinned particle:
/// what lies on both sides of a pin shares no unknown. Newton's matrix is tridiagonal in each chain.
///
/// The squared lengths are quadratic in the impulses, so what a Newton step leaves of them is known without a
/// further evaluation: exactly | span du |^2, du being the change of the bar's relative velocity.
class ChainConstraints final : public ConstraintSolver {
  public:
    /// Whether all of these bars join particle i to particle i + 1, in ascending order; also where there are
    /// none.
    [[nodiscard]] static bool suits(std::span<const Bar> bars);

    /// Requires that its rigid bars suit. Throws corda::Error for a chain that is pinned at both ends and
    /// straight.
    explicit ChainConstraints(const System& system);

    [[nodiscard]] bool move(const Stage& stage, Motion& motion, std::span<double> impulse) override;
    [[nodiscard]] bool solve(const Motion& motion, std::span<double> right) override;
    [[nodiscard]] double square_frequency(std::span<const double> rate) const override;
    [[nodiscard]] std::vector<double> carried_mass(std::span<const double> mass_kg) const override;

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

    std::vector<Chain> chains_;
    std::vector<double> square_m2_;  ///< rest^2 of a link
    // Scratch of one chain. Entry k + 1 is that of its link k; the entries before the first and behind the
    // last stand for bars that are not there and are 0.
    std::vector<double> dx_m_;  ///< bar vectors at the start of the stage
    std::vector<double> dy_m_;
    std::vector<double> lower_;
    std::vector<double> diagonal_;
    std::vector<double> upper_;
    std::vector<double> right_;
    // Of one chain too, one entry a particle: velocities before the impulses, what all impulses together and
    // what the last ones change.
    std::vector<double> start_x_m_s_;
    std::vector<double> start_y_m_s_;
    std::vector<double> total_x_m_s_;
    std::vector<double> total_y_m_s_;
    std::vector<double> change_x_m_s_;
    std::vector<double> change_y_m_s_;
};

}  // namespace corda::sim
