#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "corda/sim/rattle/constraint_solver.hpp"

namespace corda::sim {

/// Eigen's sparse LDL' with a factorisation that can be interrupted: that of a large net takes seconds.
class StoppableLdlt final : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
  public:
    /// Factorises the matrix with this lower triangle, whose pattern has been analysed, by the operations of
    /// Eigen's factorize() in their order (T. Davis, Algorithm 849, ACM Transactions on Mathematical Software
    /// 31 (2005) 587). False if a pivot is 0. If it is cancelled, there are no factors.
    [[nodiscard]] bool factorize(const Eigen::SparseMatrix<double>& lower);

  private:
    /// Writes the columns of the pattern of row k of L to the end of pattern_, and that row of the matrix to
    /// row_. Returns where the pattern begins.
    int scatter(const Eigen::SparseMatrix<double>& upper, int k);

    Eigen::VectorXd row_;
    VectorI pattern_;
    VectorI visited_by_;
};

/// Bars in any graph: closed ropes, nets. The matrix G W G' at the start of a stage is factorised once per
/// stage and used for all corrections of the stage: a simplified Newton method. Bars that others imply at the
/// start are left out; a stage fails if one of them loses its length. See section 3.4 of
/// src/corda/sim/README.md.
class GraphConstraints final : public ConstraintSolver {
  public:
    /// Throws corda::Refusal for bars that depend on each other at the start and do not stay so.
    explicit GraphConstraints(const System& system);

    [[nodiscard]] bool move(const Stage& stage, Motion& motion, std::span<double> impulse) override;
    [[nodiscard]] bool tells_tensions() const override;
    [[nodiscard]] double distance_from_line(const Motion& motion) override {
        static_cast<void>(is_regular(motion));
        return smallest_pivot_ / near_line_;
    }
    [[nodiscard]] bool leap(double span_s, Motion& motion) override;
    [[nodiscard]] bool solve(const Motion& motion, std::span<double> right) override;
    [[nodiscard]] bool had_full_rank() const override { return smallest_pivot_ > 0.0; }
    [[nodiscard]] double square_frequency(std::span<const double> multiplier) const override;
    [[nodiscard]] double expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const override;
    [[nodiscard]] bool determines_tensions() const override { return implied_.empty() && !holds_rows_; }
    [[nodiscard]] std::vector<double> carried_mass(std::span<const double> mass_kg) const override;

  private:
    /// An entry factor * (d_row . d_column) of the lower triangle, in the order of the matrix's values.
    struct Entry {
        std::uint32_t row = 0;
        std::uint32_t column = 0;
        double factor = 0.0;  ///< sum of the shared particles' inverse masses, signed
    };
    /// A system that moves only as a rigid body, about its pin or its centre of mass.
    struct Plate {
        double inertia_kg_m2 = 0.0;
        double lever_kg_m = 0.0;  ///< mass times the distance of the centre of mass
    };
    void analyse();
    /// Factorises the matrix at these positions, its diagonal entries raised by a share; does nothing if
    /// factors_ are already the result. False if it cannot.
    [[nodiscard]] bool factorise(const Motion& motion, double raise);
    /// Factorises the matrix without a raise; false also if bars depend on each other.
    [[nodiscard]] bool is_regular(const Motion& motion);
    /// Moves the links that others imply to implied_, as far as a factorisation with this raise shows them.
    void leave_out_implied(const Motion& start, double raise);
    /// True if regular links leave only the motions of a rigid body.
    [[nodiscard]] bool is_rigid() const;
    [[nodiscard]] Plate plate_of(const System& system) const;
    /// True if every motion from these positions that keeps the links' lengths keeps those of the implied
    /// bars, to second order.
    [[nodiscard]] bool stay_implied(Motion motion);
    [[nodiscard]] bool meet_implied(const Motion& motion) const;
    void apply(const double* impulse, Motion& motion) const;
    [[nodiscard]] bool correct(double span_s, const Motion& motion);
    /// The largest squared relative velocity of a link's ends.
    [[nodiscard]] double largest_square(const Motion& motion) const;
    /// Completes a stage after its kick by the full Newton method, whose matrix follows the bars to either
    /// side of their line. False if it does not converge or may have taken the other branch.
    [[nodiscard]] bool cross(double span_s, Motion& motion, std::span<double> impulse);

    bool holds_rows_;
    std::optional<Plate> plate_;
    std::vector<Link> implied_;
    std::vector<Entry> entries_;
    Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
    StoppableLdlt factors_;
    bool is_factorised_ = false;  ///< factors_ are those of dx_m_, dy_m_ and raise_
    double raise_ = 0.0;
    std::vector<double> dx_m_;  ///< bar vectors at the start of a stage
    std::vector<double> dy_m_;
    Eigen::VectorXd right_;
    double smallest_pivot_ = 1.0;  ///< of the last is_regular(), over its diagonal entry; 0 if it is not
    double near_line_ = 0.0;       ///< of smallest_pivot_
    Eigen::SparseMatrix<double> crossing_;  ///< that of cross(); empty until it is needed
    Eigen::SparseLU<Eigen::SparseMatrix<double>> crossing_factors_;
    mutable std::vector<double> load_;  ///< scratch, one entry per particle
};

}  // namespace corda::sim
