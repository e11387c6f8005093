#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "corda/core/stop_check.hpp"

namespace corda::sim {

/// Eigen's sparse LDL', with a factorisation that can be broken off: that of a large net takes seconds.
class StoppableLdlt final : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
  public:
    /// Factorises the matrix with this lower triangle, whose pattern has been analysed, by the operations of
    /// Eigen's factorize() in their order (T. Davis, Algorithm 849, ACM Transactions on Mathematical Software
    /// 31 (2005) 587). False if a pivot is 0. If `stop` throws, there are no factors.
    [[nodiscard]] bool factorize(const Eigen::SparseMatrix<double>& lower, StopCheck& stop);

  private:
    /// Writes the columns of the pattern of row k of L to the end of pattern_, and that row of the matrix to
    /// row_. Returns where the pattern begins.
    int scatter(const Eigen::SparseMatrix<double>& upper, int k);

    Eigen::VectorXd row_;
    VectorI pattern_;
    VectorI visited_by_;
};

}  // namespace corda::sim
