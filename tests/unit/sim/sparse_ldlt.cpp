#include "corda/sim/sparse_ldlt.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>
#include <random>
#include <string>
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

/// The lower triangle of a matrix with entries anywhere: a row has some `density` of those before it.
Eigen::SparseMatrix<double> random_matrix(int size, double density) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<Eigen::Triplet<double>> entries;
    for (int row = 0; row < size; ++row) {
        entries.emplace_back(row, row, 2.0 + size * density);
        for (int column = 0; column < row; ++column)
            if (any(generator) < 2.0 * density - 1.0) entries.emplace_back(row, column, any(generator));
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

TEST(SparseLdlt, HasTheSolutionAndThePivotsOfEigen) {
    std::vector<Eigen::SparseMatrix<double>> matrices;
    for (const int n : {1, 2, 3, 7, 30}) matrices.push_back(grid_matrix(n));
    for (const double density : {0.0, 0.005, 0.02, 0.1, 1.0}) matrices.push_back(random_matrix(150, density));
    SparseLdlt own;
    for (const Eigen::SparseMatrix<double>& matrix : matrices) {
        SCOPED_TRACE(std::to_string(matrix.rows()) + " rows, " + std::to_string(matrix.nonZeros()) +
                     " entries");
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigens(matrix);
        own.analyse(matrix);
        ASSERT_TRUE(own.factorise(matrix.valuePtr()));
        const Eigen::VectorXd pivots = eigens.permutationPinv() * eigens.vectorD();
        for (Eigen::Index i = 0; i < matrix.rows(); ++i)
            ASSERT_NEAR(own.pivot(static_cast<std::size_t>(i)), pivots[i], 1e-13 * pivots[i]) << i;
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1.0, 2.0);
        const Eigen::VectorXd expected = eigens.solve(right);
        Eigen::VectorXd solved = right;
        own.solve(solved.data());
        EXPECT_LT((solved - expected).lpNorm<Eigen::Infinity>(), 1e-13 * expected.lpNorm<Eigen::Infinity>());
        ASSERT_TRUE(own.factorise(matrix.valuePtr()));
        Eigen::VectorXd again = right;
        own.solve(again.data());
        EXPECT_TRUE(again == solved);
    }
}

/// Two matrices that share no row.
Eigen::SparseMatrix<double> both(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::Index first = 0;
    for (const auto* const matrix : {&a, &b}) {
        for (Eigen::Index column = 0; column < matrix->cols(); ++column)
            for (Eigen::SparseMatrix<double>::InnerIterator it(*matrix, column); it; ++it)
                entries.emplace_back(first + it.row(), first + column, it.value());
        first += matrix->rows();
    }
    Eigen::SparseMatrix<double> matrix(first, first);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

/// The solution for ones after factorise(), which must succeed.
Eigen::VectorXd solution(SparseLdlt& factors, const Eigen::SparseMatrix<double>& matrix) {
    EXPECT_TRUE(factors.factorise(matrix.valuePtr()));
    Eigen::VectorXd solved = Eigen::VectorXd::Ones(matrix.cols());
    factors.solve(solved.data());
    return solved;
}

Eigen::VectorXd solution(const Eigen::SparseMatrix<double>& matrix) {
    SparseLdlt fresh;
    fresh.analyse(matrix);
    return solution(fresh, matrix);
}

TEST(SparseLdlt, FactorisesOtherEntriesOfThePatternWithTheBitsOfNewFactors) {
    const Eigen::SparseMatrix<double> matrix = both(grid_matrix(20), random_matrix(150, 0.1));
    Eigen::SparseMatrix<double> other = matrix;
    other.diagonal() *= 1.5;
    SparseLdlt factors;
    factors.analyse(matrix);
    const Eigen::VectorXd first = solution(factors, matrix);
    EXPECT_TRUE(first == solution(matrix));
    EXPECT_TRUE(solution(factors, other) == solution(other));
    EXPECT_TRUE(solution(factors, matrix) == first);
    // Matrices that share no row do not change one another.
    EXPECT_LT((first.head(400) - solution(grid_matrix(20))).lpNorm<Eigen::Infinity>(), 1e-13);
}

TEST(SparseLdlt, FindsAPivotOfZeroOrNanAndStartsAgain) {
    Eigen::SparseMatrix<double> pair(2, 2);
    for (const auto& [row, column] : {std::pair{0, 0}, {1, 0}, {1, 1}}) pair.insert(row, column) = 1.0;
    pair.makeCompressed();
    // Dependent rows amid those that are eliminated before and after.
    const Eigen::SparseMatrix<double> matrix = both(grid_matrix(20), both(pair, random_matrix(150, 1.0)));
    SparseLdlt factors;
    factors.analyse(matrix);
    EXPECT_FALSE(factors.factorise(matrix.valuePtr()));
    Eigen::SparseMatrix<double> good = matrix;
    good.coeffRef(401, 401) = 3.0;
    EXPECT_TRUE(solution(factors, good) == solution(good));
    Eigen::SparseMatrix<double> bad = good;
    bad.coeffRef(410, 405) = std::numeric_limits<double>::quiet_NaN();
    static_cast<void>(factors.factorise(bad.valuePtr()));
    EXPECT_TRUE(std::isnan(factors.pivot(410)) || std::isnan(factors.pivot(405)));
    EXPECT_TRUE(solution(factors, good) == solution(good));
}

TEST(SparseLdlt, CanBeCancelledAndStartAgain) {
    for (const Eigen::SparseMatrix<double>& matrix : {grid_matrix(120), random_matrix(600, 1.0)}) {
        SparseLdlt factors;
        factors.analyse(matrix);
        int asked = 0;
        {
            const CancelScope stop([&asked] { return ++asked < 2; });
            EXPECT_THROW(static_cast<void>(factors.factorise(matrix.valuePtr())), Error);
        }
        EXPECT_EQ(asked, 2);
        const Eigen::VectorXd solved = solution(factors, matrix);
        EXPECT_TRUE(solved == solution(matrix));
        const Eigen::VectorXd right = Eigen::VectorXd::Ones(matrix.cols());
        const Eigen::VectorXd product = matrix.selfadjointView<Eigen::Lower>() * solved;
        EXPECT_LT((product - right).lpNorm<Eigen::Infinity>(), 1e-11);  // measured 1e-13
    }
}

}  // namespace
}  // namespace corda::sim
