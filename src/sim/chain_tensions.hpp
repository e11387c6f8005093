#pragma once

#include <cstddef>

namespace corda::sim {

// The elimination of the tensions of a chain in O(n), without cancellation however unequal the masses are and
// however straight the chain is. Derivation: section 3 of src/sim/exact/README.md.

/// The inverse mass that the part of a chain eliminated so far shows to a pull along its last link, as a
/// fraction p / q, so that no division waits for another one.
struct InverseMassFraction {
    double p = 0.0;  ///< at first the inverse mass of the chain's last particle
    double q = 1.0;

    /// The pivot of the last link, times q, if its other particle has this inverse mass.
    [[nodiscard, gnu::always_inline]] double divisor(double inverse_mass) const {
        return p + inverse_mass * q;
    }
    /// Goes on past that particle to the next link. `sine` is the sine of the angle between the two, times
    /// the inverse mass; `divisor` is that of the particle. Returns a factor by which p and q were scaled to
    /// keep them in range: a power of two, usually 1.
    [[gnu::always_inline]] double pass(double inverse_mass, double square_sine, double divisor) {
        constexpr double kLarge = 0x1p+300;
        constexpr double kSmall = 0x1p-300;
        p = inverse_mass * p + square_sine * q;
        q = divisor;
        if (!(q > kLarge || q < kSmall)) return 1.0;
        const double scale = q > 1.0 ? kSmall : kLarge;
        p *= scale;
        q *= scale;
        return scale;
    }
};

/// The matrix of the tensions of a chain of `count` links. Link i joins particles i-1 and i of inverse masses
/// W_{i-1} and W_i; C_i and S_i are cosine and sine of the angle from link i to link i+1. Row i is
///
///   (W_{i-1} + W_i) T_i - W_{i-1} C_{i-1} T_{i-1} - W_i C_i T_{i+1} = right-hand side.
struct TensionMatrix {
    std::size_t count = 0;
    double first_inverse_mass = 0.0;       ///< W_{-1}, of the particle at the near end of link 0
    const double* inverse_mass = nullptr;  ///< W_i
    const double* cosine = nullptr;        ///< W_i C_i, i < count - 1
    const double* sine = nullptr;          ///< W_i S_i
};

/// Solves for `tension`, which may be `right` itself. `pivot` and `weight` are scratch, one entry per link.
void solve_tensions(const TensionMatrix& matrix, const double* right, double* pivot, double* weight,
                    double* tension);

}  // namespace corda::sim
