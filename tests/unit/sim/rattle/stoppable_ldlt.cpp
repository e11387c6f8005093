#include "corda/sim/rattle/stoppable_ldlt.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace corda::sim {
namespace {

/// The lower triangle of the matrix of a grid of springs, n x n, held at its sides.
Eigen::SparseMatrix<double> grid_matrix(int n) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n * n; ++i) {
        entries.emplace_back(i, i, 4.0 + 0.01 * (i % 7));
        if (i % n + 1 < n) entries.emplace_back(i + 1, i, -1.0 + 0.001 * (i % 5));
        if (i + n < n * n) entries.emplace_back(i + n, i, -1.0);
    }
    Eigen::SparseMatrix<double> matrix(n * n, n * n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

TEST(StoppableLdlt, HasTheBitsOfEigens) {
    for (const int n : {1, 2, 7, 30}) {
        const Eigen::SparseMatrix<double> matrix = grid_matrix(n);
        Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigens;
        eigens.analyzePattern(matrix);
        eigens.factorize(matrix);
        StoppableLdlt own;
        own.analyzePattern(matrix);
        StopCheck nobody;
        ASSERT_TRUE(own.factorize(matrix, nobody)) << n;
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n * n, -1.0, 2.0);
        EXPECT_TRUE(own.solve(right) == eigens.solve(right)) << n;
        EXPECT_TRUE(own.vectorD() == eigens.vectorD()) << n;
    }
}

TEST(StoppableLdlt, FindsAPivotOfZero) {
    Eigen::SparseMatrix<double> matrix(2, 2);
    for (const auto& [row, column] : {std::pair{0, 0}, {1, 0}, {1, 1}}) matrix.insert(row, column) = 1.0;
    StoppableLdlt own;
    own.analyzePattern(matrix);
    StopCheck nobody;
    EXPECT_FALSE(own.factorize(matrix, nobody));
}

TEST(StoppableLdlt, IsBrokenOffAndCanBeginAnew) {
    const Eigen::SparseMatrix<double> matrix = grid_matrix(120);
    StoppableLdlt own;
    own.analyzePattern(matrix);
    int asked = 0;
    const GoesOn goes_on = [&asked] { return ++asked < 2; };
    StopCheck stop(goes_on);
    EXPECT_THROW(static_cast<void>(own.factorize(matrix, stop)), Error);
    EXPECT_EQ(asked, 2);
    StopCheck nobody;
    ASSERT_TRUE(own.factorize(matrix, nobody));
    const Eigen::VectorXd right = Eigen::VectorXd::Ones(matrix.cols());
    const Eigen::VectorXd solved = own.solve(right);
    const Eigen::VectorXd product = matrix.selfadjointView<Eigen::Lower>() * solved;
    EXPECT_LT((product - right).lpNorm<Eigen::Infinity>(), 1e-11);  // measured 1e-13
}

}  // namespace
}  // namespace corda::sim
