#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace corda::sim {

/// Which links of a chain pull, and how strongly, when a link can pull and never push: a linear
/// complementarity problem. For links k at their rest lengths, find z with
///
///   z_k >= 0,   w_k = (A z - b)_k >= 0,   z_k w_k = 0,
///   (A z)_k = (W_k + W_{k+1}) z_k - W_k C_{k-1} z_{k-1} - W_{k+1} C_k z_{k+1},
///
/// where link k joins particles k and k+1 of inverse masses W and C_k is the cosine between links k and k+1.
/// With the speeds of separation for b, z are the impulses of a plastic snap and -w the speeds after it; with
/// the accelerations of separation, z are the tensions.
///
/// A is symmetric and positive definite wherever no links are straight between two pins, so there is one
/// solution. It is found by block principal pivoting: all links whose sign is wrong change sides at once,
/// while that leaves fewer and fewer of them; else, the last one alone (Murty), which terminates. Sources:
/// J. Judice, F. Pires, Computers and Operations Research 21 (1994) 587; K. Murty, Linear Complementarity,
/// Linear and Nonlinear Programming, Heldermann 1988, ch. 4.
class TensionLcp {
  public:
    enum class Side : std::uint8_t {
        kAbsent,  ///< not at its rest length: no row
        kFree,    ///< z = 0
        kPulls,   ///< w = 0
    };

    /// `inverse_mass_1_kg`: W, one a particle; 0: pinned.
    explicit TensionLcp(std::vector<double> inverse_mass_1_kg);

    // To be filled in before solve(); one entry a link.
    std::vector<Side> side;       ///< a first guess, then the solution's
    std::vector<double> right;    ///< b
    std::vector<double> cosine;   ///< C_k, where links k and k+1 are present
    std::vector<double> sine;     ///< the sine of the same angle
    std::vector<double> z_error;  ///< z above minus this counts as no less than 0

    /// False where no solution was found. `w_error`: w above minus this counts as no less than 0; such a
    /// link, and one whose z is negative by no more than its error, stays on the side of the first guess.
    [[nodiscard]] bool solve(double w_error);

    [[nodiscard]] const std::vector<double>& z() const { return z_; }
    [[nodiscard]] const std::vector<double>& w() const { return w_; }

  private:
    void solve_pulling();
    [[nodiscard]] bool has_wrong_sign(std::size_t link, double w_error) const;

    std::vector<double> inverse_mass_1_kg_;
    std::vector<double> pivot_;
    std::vector<double> z_;
    std::vector<double> w_;
    std::vector<std::size_t> wrong_;
};

}  // namespace corda::sim
