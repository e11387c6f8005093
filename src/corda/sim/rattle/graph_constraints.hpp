#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/sparse_ldlt.hpp"

namespace corda::sim {

/// Rigid bars and the matrix G W G' of their impulses, with its factors. Bars that others imply at the start
/// are left out: see section 3.4 of src/corda/sim/README.md.
struct BarGraph {
    /// An entry factor * (d_row . d_column) of the lower triangle.
    struct Entry {
        std::uint32_t row = 0;
        std::uint32_t column = 0;
        double factor = 0.0;  ///< sum of the shared particles' inverse masses, signed
    };

    /// Throws corda::Refusal for bars that depend on each other at the start and do not stay so.
    explicit BarGraph(const System& system);

    RigidBars bars;
    std::vector<Link> implied;
    std::vector<Entry> entries;          ///< in the order of the matrix's values
    Eigen::SparseMatrix<double> matrix;  ///< lower triangle
    SparseLdlt factors;
    std::vector<std::size_t> diagonal;  ///< the values on it
    bool is_factorised = false;         ///< the factors are those of dx_m, dy_m and raise
    double raise = 0.0;
    std::vector<double> dx_m;  ///< bar vectors at the start of a stage
    std::vector<double> dy_m;
    double smallest_pivot = 1.0;  ///< of the last is_regular(), over its diagonal entry; 0 if it is not
    Eigen::VectorXd right;        ///< scratch, one entry per link
};

/// A system that moves only as a rigid body, about its pin or its centre of mass.
struct RigidPlate {
    double inertia_kg_m2 = 0.0;
    double lever_kg_m = 0.0;  ///< mass times the distance of the centre of mass
};

/// Newton's matrix with the bars at the end of a stage on one side; empty until it is needed.
struct CrossingMatrix {
    Eigen::SparseMatrix<double> matrix;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> factors;
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
    [[nodiscard]] bool tells_tensions() const override { return graph_.smallest_pivot >= near_line_; }
    [[nodiscard]] double distance_from_line(const Motion& motion) override;
    [[nodiscard]] bool leap(double span_s, Motion& motion) override;
    [[nodiscard]] bool solve(const Motion& motion, std::span<double> right) override;
    [[nodiscard]] bool had_full_rank() const override { return graph_.smallest_pivot > 0.0; }
    [[nodiscard]] double square_frequency(std::span<const double> multiplier) const override;
    [[nodiscard]] double expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const override;
    [[nodiscard]] bool determines_tensions() const override { return graph_.implied.empty() && !holds_rows_; }
    [[nodiscard]] std::vector<double> carried_mass(std::span<const double> mass_kg) const override;
    [[nodiscard]] const RigidBars& bars() const override { return graph_.bars; }

  private:
    BarGraph graph_;
    bool holds_rows_;
    std::optional<RigidPlate> plate_;
    double near_line_;  ///< of BarGraph::smallest_pivot
    CrossingMatrix crossing_;
    mutable std::vector<double> load_;  ///< scratch, one entry per particle
};

}  // namespace corda::sim
