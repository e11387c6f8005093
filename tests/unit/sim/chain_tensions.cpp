#include "corda/sim/chain_tensions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

namespace corda::sim {
namespace {

/// A chain with its matrix, of random angles and of masses within a factor of 10^`decades` of each other.
struct Problem {
    std::vector<double> inverse_mass;  ///< one more than links; the first is that of the start
    std::vector<double> cosine;
    std::vector<double> sine;
    std::vector<double> right;

    Problem(std::size_t links, double decades, bool is_pinned, std::mt19937& random) {
        const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
        for (std::size_t i = 0; i <= links; ++i) inverse_mass.push_back(std::pow(10.0, decades * uniform()));
        if (is_pinned) inverse_mass[0] = 0.0;
        for (std::size_t i = 0; i < links; ++i) {
            const double angle = 6.2831853 * uniform();
            cosine.push_back(inverse_mass[i + 1] * std::cos(angle));
            sine.push_back(inverse_mass[i + 1] * std::sin(angle));
            right.push_back(2.0 * uniform() - 1.0);
        }
    }
    [[nodiscard]] std::vector<double> solve() const {
        const std::size_t links = right.size();
        std::vector<double> pivot(links), weight(links), tension(links);
        solve_tensions({links, inverse_mass[0], &inverse_mass[1], cosine.data(), sine.data()}, right.data(),
                       pivot.data(), weight.data(), tension.data());
        return tension;
    }
    [[nodiscard]] Eigen::VectorXd solve_densely() const {
        const auto links = static_cast<Eigen::Index>(right.size());
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(links, links);
        for (Eigen::Index i = 0; i < links; ++i) {
            const auto k = static_cast<std::size_t>(i);
            matrix(i, i) = inverse_mass[k] + inverse_mass[k + 1];
            if (i + 1 < links) matrix(i, i + 1) = matrix(i + 1, i) = -cosine[k];
        }
        return matrix.fullPivLu().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), links));
    }
};

TEST(ChainTensions, AreThoseOfADenseElimination) {
    std::mt19937 random(3);
    double largest_error = 0.0;
    for (std::size_t links = 1; links <= 60; ++links) {
        for (const bool is_pinned : {false, true}) {
            const Problem problem(links, 1.0, is_pinned, random);
            const std::vector<double> tension = problem.solve();
            const Eigen::VectorXd expected = problem.solve_densely();
            const double unit = expected.cwiseAbs().maxCoeff();
            for (std::size_t i = 0; i < links; ++i) {
                const double error = std::abs(tension[i] - expected(static_cast<Eigen::Index>(i))) / unit;
                largest_error = std::max(largest_error, error);
            }
        }
    }
    std::printf("chain tensions: off by %.1e of the largest\n", largest_error);
    EXPECT_LT(largest_error, 1e-13);  // measured 9.7e-16
}

/// A hanging chain carries what hangs below each link, however heavy its end is and however long it is: an
/// elimination that subtracts would lose as many digits as there are powers of ten between the masses.
TEST(ChainTensions, LoseNoDigitToUnequalMasses) {
    for (const double tip_kg : {1e-6, 1.0, 1e6, 1e12}) {
        for (const std::size_t links : {1U, 2U, 10U, 1000U}) {
            std::vector<double> inverse_mass(links + 1, 1.0);
            inverse_mass.front() = 0.0;
            inverse_mass.back() = 1.0 / tip_kg;
            const std::vector<double> cosine(inverse_mass.begin() + 1, inverse_mass.end());
            const std::vector<double> sine(links, 0.0);
            std::vector<double> tension(links, 0.0);
            tension[0] = 10.0;  // gravity pulls the first link away from its pin
            std::vector<double> pivot(links), weight(links);
            solve_tensions({links, 0.0, &inverse_mass[1], cosine.data(), sine.data()}, tension.data(),
                           pivot.data(), weight.data(), tension.data());
            for (std::size_t i = 0; i < links; ++i) {
                const double below_kg = tip_kg + static_cast<double>(links - 1 - i);
                EXPECT_NEAR(tension[i] / (10.0 * below_kg), 1.0, 1e-12) << tip_kg << " " << links << " " << i;
            }
        }
    }
}

/// Numbers between -1 and 1, the same everywhere.
class Numbers {
  public:
    double operator()() { return static_cast<double>(random_()) / 2147483648.0 - 1.0; }

  private:
    std::mt19937 random_{1};
};

TEST(Tridiagonal, MatchesDenseElimination) {
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

TEST(Tridiagonal, GivesNumbersThatAreNotFiniteForAZeroPivot) {
    std::vector<double> lower{0.0, 1.0}, diagonal{1.0, 1.0}, upper{1.0, 0.0}, right{1.0, 2.0};
    solve_tridiagonal(2, lower.data(), diagonal.data(), upper.data(), right.data());
    EXPECT_FALSE(std::isfinite(right[0]) && std::isfinite(right[1]));
}

}  // namespace
}  // namespace corda::sim
