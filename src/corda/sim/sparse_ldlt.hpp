#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace corda::sim {

/// L D L' of a sparse symmetric matrix, whose pattern is analysed once, by the multifrontal method (I. Duff
/// and J. Reid, ACM Transactions on Mathematical Software 9 (1983) 302) in Eigen's approximate minimum degree
/// ordering, postordered. Consecutive columns of similar pattern form a block (a relaxed supernode), with
/// zeros where the pattern has no entry. A factorisation can be cancelled: that of a large net takes seconds.
/// There are no factors then.
class SparseLdlt {
  public:
    /// Columns of L with entries in their own rows and in those below the block.
    struct Block {
        std::uint32_t first = 0;  ///< column
        std::uint32_t columns = 0;
        std::uint32_t below = 0;
        std::uint32_t begin = 0;  ///< index in row_ of the first row below
        std::size_t value = 0;    ///< the first entry in value_
        std::size_t stride = 0;   ///< from column to column
        /// Changes by the columns in those of the rows below, kept until they are added to the parent, the
        /// block of the first row below.
        std::size_t update = 0;
        std::size_t update_stride = 0;
        std::uint32_t stack = 0;  ///< index in stack_ of the memory of the update
        std::uint32_t child = 0;  ///< the first block whose parent this is
        std::uint32_t next = 0;   ///< the next one with the same parent
    };

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
        std::uint32_t entry = 0;
        std::size_t value = 0;
    };

    void order(const Eigen::SparseMatrix<double>& lower);
    void find_blocks(const Eigen::SparseMatrix<double>& lower);
    void find_parents();
    void find_memory();
    void find_sources(const Eigen::SparseMatrix<double>& lower);
    void add_updates(const Block& block);

    std::vector<std::uint32_t> place_;     ///< of each row of the matrix in the order of elimination
    std::vector<Block> blocks_;            ///< children before their parent
    std::vector<std::uint32_t> block_of_;  ///< of each column
    std::vector<std::uint32_t> row_;       ///< below each block, padded to whole Fours with its last column
    std::vector<std::uint32_t> to_;        ///< the same, counted from the first row of the parent
    std::vector<Source> source_;           ///< where the entries of the matrix belong
    std::vector<double> value_;            ///< 0 in rows of padding; anything above the diagonal
    std::vector<double> pivot_;
    std::vector<double> inverse_pivot_;
    /// Updates of blocks at even and at odd depths of the tree, so that a block's own is not among those
    /// which are added to it.
    std::array<std::vector<double>, 2> stack_;
    std::vector<double> solution_;
};

}  // namespace corda::sim
