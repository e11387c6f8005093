#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace corda::sim {

/// A linear complementarity problem with a symmetric tridiagonal matrix A, positive semidefinite: find z >= 0
/// with w = A z - b >= 0 and z_k w_k = 0.
struct TridiagonalLcp {
    std::vector<double> diagonal;  ///< A_kk > 0
    std::vector<double> beside;    ///< A_k,k+1; one less, the last entry is not read
    std::vector<double> right;     ///< b
};

/// Guesses which z_k are positive: 1 where they are, 0 where w_k is; either where both are almost 0. Takes
/// about 30 solutions of all rows, whatever their number, and at most 100. Mehrotra's predictor-corrector
/// method: S. Wright, Primal-Dual Interior-Point Methods, SIAM 1997, ch. 8 and 10.
[[nodiscard]] std::vector<std::uint8_t> guess_positive(TridiagonalLcp problem);

/// Which links of a chain pull, and how strongly, if a link can pull and never push: a linear complementarity
/// problem. For links k at their rest lengths, find z with
///
///   z_k >= 0,   w_k = (A z - b)_k >= 0,   z_k w_k = 0,
///   (A z)_k = (W_k + W_{k+1}) z_k - W_k C_{k-1} z_{k-1} - W_{k+1} C_k z_{k+1},
///
/// where link k joins particles k and k+1 of inverse masses W and C_k is the cosine between links k and k+1.
/// If b is the speeds of separation, z is the impulses of a plastic snap and -w the speeds after it; if b is
/// the accelerations of separation, z is the tensions.
///
/// A is positive definite unless links are straight between two pins, so there is one solution. It is found
/// by block principal pivoting: all links of wrong sign change sides at once while this leaves fewer of them,
/// otherwise the last one alone (Murty), which terminates but may take a round per link. After 50 rounds an
/// interior-point method makes a new guess. Sources: J. Judice, F. Pires, Computers and Operations Research
/// 21 (1994) 587; K. Murty, Linear Complementarity, Linear and Nonlinear Programming, Heldermann 1988, ch. 4.
class TensionLcp {
  public:
    enum class Side : std::uint8_t {
        kAbsent,  ///< not at its rest length: no row
        kFree,    ///< z = 0
        kPulls,   ///< w = 0
    };

    /// `inverse_mass_1_kg`: W, one per particle; 0: pinned.
    explicit TensionLcp(std::vector<double> inverse_mass_1_kg);

    // Input of solve(), one entry per link.
    std::vector<Side> side;       ///< a guess; after solve() the solution's
    std::vector<double> right;    ///< b
    std::vector<double> cosine;   ///< C_k, if links k and k+1 are both present
    std::vector<double> sine;     ///< the sine of the same angle
    std::vector<double> z_error;  ///< z above minus this counts as >= 0

    /// False if no solution was found. `w_error`: w above minus this counts as >= 0. A link whose z or w is
    /// negative by no more than its error stays on the side of the guess.
    [[nodiscard]] bool solve(double w_error);

    [[nodiscard]] const std::vector<double>& z() const { return z_; }
    [[nodiscard]] const std::vector<double>& w() const { return w_; }

  private:
    /// False if `most_rounds` do not find the solution.
    [[nodiscard]] bool pivot(std::size_t most_rounds, double w_error);
    void guess_by_interior_point();
    /// Takes links that may be on either side within the errors back to the side of guess_.
    void keep_guess_within_errors(double w_error);
    void solve_pulling();
    [[nodiscard]] bool has_wrong_sign(std::size_t link, double w_error) const;

    std::vector<double> inverse_mass_1_kg_;
    std::vector<Side> guess_;  ///< of the caller
    // Scratch of solve_pulling().
    std::vector<double> cosine_;  ///< W_{k+1} C_k
    std::vector<double> sine_;    ///< W_{k+1} S_k
    std::vector<double> pivot_;
    std::vector<double> weight_;
    std::vector<double> z_;
    std::vector<double> w_;
    std::vector<std::size_t> wrong_;
};

}  // namespace corda::sim
