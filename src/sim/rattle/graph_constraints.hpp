#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/rattle/stoppable_ldlt.hpp"

namespace corda::sim {

/// Bars in any graph: closed ropes, nets. The matrix G W G' at the start of a stage is factorised once per
/// stage (Eigen's sparse LDL', its pattern and order analysed once) and used for all corrections of the
/// stage. This is Newton's method with the matrix of a moment ago: each correction multiplies the error by
/// about the sine of the angle by which bars turn.
class GraphConstraints final : public ConstraintSolver {
  public:
    /// Throws corda::Refusal for bars whose lengths depend on each other. `goes_on`: see Rattle.
    explicit GraphConstraints(const System& system, const GoesOn& goes_on = {});

    [[nodiscard]] bool move(const Stage& stage, Motion& motion, std::span<double> impulse,
                            StopCheck& stop) override;
    [[nodiscard]] bool solve(const Motion& motion, std::span<double> right, StopCheck& stop) override;
    [[nodiscard]] double square_frequency(std::span<const double> multiplier) const override;
    [[nodiscard]] std::vector<double> carried_mass(std::span<const double> mass_kg) const override;

  private:
    /// An entry factor * (d_row . d_column) of the lower triangle, in the order of the matrix's values.
    struct Entry {
        std::uint32_t row = 0;
        std::uint32_t column = 0;
        double factor = 0.0;  ///< sum of the shared particles' inverse masses, signed
    };
    void analyse();
    /// Makes factors_ those at these positions; takes no time if they are already.
    [[nodiscard]] bool factorise(const Motion& motion, StopCheck& stop);
    void apply(const double* impulse, Motion& motion) const;
    [[nodiscard]] bool correct(double span_s, const Motion& motion);

    std::vector<Entry> entries_;
    Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
    StoppableLdlt factors_;
    bool is_factorised_ = false;  ///< factors_ are those of dx_m_ and dy_m_
    std::vector<double> dx_m_;    ///< bar vectors at the start of a stage
    std::vector<double> dy_m_;
    Eigen::VectorXd right_;
    mutable std::vector<double> load_;  ///< scratch, one entry per particle
};

}  // namespace corda::sim
