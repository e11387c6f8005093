#include "corda/sim/tridiagonal.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

namespace corda::sim {
namespace {

/// Numbers between -1 and 1, the same everywhere.
class Numbers {
  public:
    double operator()() { return static_cast<double>(random_()) / 2147483648.0 - 1.0; }

  private:
    std::mt19937 random_{1};
};

TEST(Tridiagonal, SolvesWhatDenseEliminationSolves) {
    Numbers draw;
    double largest_error = 0.0;
    for (std::size_t count = 1; count <= 60; ++count) {
        std::vector<double> lower(count), diagonal(count), upper(count), right(count);
        const auto size = static_cast<Eigen::Index>(count);
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
        Eigen::VectorXd dense_right(size);
        for (std::size_t k = 0; k < count; ++k) {
            const auto row = static_cast<Eigen::Index>(k);
            lower[k] = draw();
            upper[k] = draw();
            diagonal[k] = 3.0 + draw();  // no pivoting is needed
            right[k] = draw();
            dense(row, row) = diagonal[k];
            if (k > 0) dense(row, row - 1) = lower[k];
            if (k + 1 < count) dense(row, row + 1) = upper[k];
            dense_right(row) = right[k];
        }
        const Eigen::VectorXd expected = dense.fullPivLu().solve(dense_right);
        solve_tridiagonal(count, lower.data(), diagonal.data(), upper.data(), right.data());
        for (std::size_t k = 0; k < count; ++k) {
            const double error = std::abs(right[k] - expected(static_cast<Eigen::Index>(k)));
            largest_error = std::max(largest_error, error);
        }
    }
    std::printf("tridiagonal: off by %.1e\n", largest_error);
    EXPECT_LT(largest_error, 1e-14);  // measured 2.2e-16
}

TEST(Tridiagonal, ShowsAZeroPivotAsANumberThatIsNotFinite) {
    std::vector<double> lower{0.0, 1.0}, diagonal{1.0, 1.0}, upper{1.0, 0.0}, right{1.0, 2.0};
    solve_tridiagonal(2, lower.data(), diagonal.data(), upper.data(), right.data());
    EXPECT_FALSE(std::isfinite(right[0]) && std::isfinite(right[1]));
}

}  // namespace
}  // namespace corda::sim
