#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace corda::sim {

/// L D L' of a sparse symmetric matrix, whose pattern is analysed once: row by row of L (T. Davis, Algorithm
/// 849, ACM Transactions on Mathematical Software 31 (2005) 587), in Eigen's approximate minimum degree
/// ordering. Consecutive columns of the same pattern are subtracted together, entry by entry from the first
/// to the last one, so the bits are those of Eigen::SimplicialLDLT, in two thirds of its time. A
/// factorisation can be cancelled: that of a large net takes seconds. There are no factors then.
class SparseLdlt {
  public:
    /// The matrices have entries where this lower triangle has some.
    void analyse(const Eigen::SparseMatrix<double>& lower);

    /// Factorises the matrix with these entries, in the order of the lower triangle's. False if a pivot is 0.
    [[nodiscard]] bool factorise(const double* entries);

    /// The pivot of a row of the matrix.
    [[nodiscard]] double pivot(std::size_t row) const { return pivot_[place_[row]]; }

    /// Replaces a right-hand side by the solution.
    void solve(double* x);

  private:
    struct Source {
        std::uint32_t column = 0;
        std::uint32_t entry = 0;
    };
    /// Consecutive columns that a row of L has, all of the same pattern below the last.
    struct Run {
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };

    void order(const Eigen::SparseMatrix<double>& lower);
    void find_columns();
    void find_runs();
    /// Eliminates a run of columns from a row; returns the number of products.
    std::uint64_t eliminate(const Run& run, double& diagonal);

    std::vector<std::uint32_t> place_;  ///< of each row of the matrix in the order of elimination
    std::vector<std::uint32_t> source_begin_;
    std::vector<Source> source_;  ///< the entries of each row's lower triangle, in the order of elimination
    std::vector<std::uint32_t> parent_;  ///< of each column: the next one that it changes
    std::vector<std::uint32_t> run_begin_;
    std::vector<Run> runs_;  ///< of each row of L, in an order in which it can be eliminated
    std::vector<std::uint32_t> begin_;
    std::vector<std::uint32_t> index_;
    std::vector<double> value_;  ///< of L by columns
    std::vector<double> pivot_;
    // Scratch: entries that the columns have so far, a row of the matrix, a run of it, and a solution.
    std::vector<std::uint32_t> filled_;
    std::vector<double> row_, gathered_, solution_;
};

}  // namespace corda::sim
