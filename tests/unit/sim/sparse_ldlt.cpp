#include "corda/sim/sparse_ldlt.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <utility>
#include <vector>

#include "corda/core/cancel.hpp"

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

TEST(SparseLdlt, HasTheBitsOfEigen) {
    for (const int n : {1, 2, 7, 30}) {
        const Eigen::SparseMatrix<double> matrix = grid_matrix(n);
        Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigens;
        eigens.analyzePattern(matrix);
        eigens.factorize(matrix);
        SparseLdlt own;
        own.analyse(matrix);
        ASSERT_TRUE(own.factorise(matrix.valuePtr())) << n;
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n * n, -1.0, 2.0);
        Eigen::VectorXd solved = right;
        own.solve(solved.data());
        EXPECT_TRUE(solved == eigens.solve(right)) << n;
    }
}

TEST(SparseLdlt, FindsAPivotOfZero) {
    Eigen::SparseMatrix<double> matrix(2, 2);
    for (const auto& [row, column] : {std::pair{0, 0}, {1, 0}, {1, 1}}) matrix.insert(row, column) = 1.0;
    matrix.makeCompressed();
    SparseLdlt own;
    own.analyse(matrix);
    EXPECT_FALSE(own.factorise(matrix.valuePtr()));
}

TEST(SparseLdlt, CanBeCancelledAndStartAgain) {
    const Eigen::SparseMatrix<double> matrix = grid_matrix(120);
    SparseLdlt own;
    own.analyse(matrix);
    int asked = 0;
    {
        const CancelScope stop([&asked] { return ++asked < 2; });
        EXPECT_THROW(static_cast<void>(own.factorise(matrix.valuePtr())), Error);
    }
    EXPECT_EQ(asked, 2);
    ASSERT_TRUE(own.factorise(matrix.valuePtr()));
    const Eigen::VectorXd right = Eigen::VectorXd::Ones(matrix.cols());
    Eigen::VectorXd solved = right;
    own.solve(solved.data());
    const Eigen::VectorXd product = matrix.selfadjointView<Eigen::Lower>() * solved;
    EXPECT_LT((product - right).lpNorm<Eigen::Infinity>(), 1e-11);  // measured 1e-13
}

}  // namespace
}  // namespace corda::sim
