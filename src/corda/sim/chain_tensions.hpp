#pragma once

#include <cstddef>

namespace corda::sim {

// The elimination of the tensions of a chain in O(n), without cancellation however unequal the masses are and
// however straight the chain is. Derivation: section 3 of src/corda/sim/exact/README.md.

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
inline void solve_tensions(const TensionMatrix& matrix, const double* right, double* __restrict pivot,
                           double* __restrict weight, double* tension) {
    const std::size_t count = matrix.count;
    const double* const inverse_mass = matrix.inverse_mass;
    const double* const cosine = matrix.cosine;
    const double* const sine = matrix.sine;
    InverseMassFraction beyond{inverse_mass[count - 1]};
    double load = right[count - 1];  // of the row, times q
    for (std::size_t i = count - 1; i > 0; --i) {
        const double before = inverse_mass[i - 1];
        const double divisor = beyond.divisor(before);
        pivot[i] = divisor;
        weight[i] = beyond.q;
        tension[i] = load;
        load = right[i - 1] * divisor + cosine[i - 1] * load;
        const double scale = beyond.pass(before, sine[i - 1] * sine[i - 1], divisor);
        if (scale != 1.0) load *= scale;
    }
    tension[0] = load / beyond.divisor(matrix.first_inverse_mass);
    for (std::size_t i = 1; i < count; ++i) {
        const double inverse = 1.0 / pivot[i];
        tension[i] *= inverse;
        weight[i] *= cosine[i - 1] * inverse;
    }
    for (std::size_t i = 1; i < count; ++i) tension[i] += weight[i] * tension[i - 1];
}

/// Solves a tridiagonal system in place, without pivoting, from both ends at once: the two recurrences do not
/// wait for each other, which halves the time that the chain of divisions takes. Row k is
///
///   lower[k] z[k-1] + diagonal[k] z[k] + upper[k] z[k+1] = right[k],  0 <= k < count, count >= 1.
///
/// lower[0] and upper[count-1] are not read. On return `right` holds z; the other arrays are overwritten.
/// With a zero pivot the result is not finite. The matrix need not be symmetric; for the tensions of a chain
/// see chain_tensions.hpp, which loses no digits to cancellation.
inline void solve_tridiagonal(std::size_t count, double* lower, double* diagonal, double* upper,
                              double* right) {
    // Rows 0..middle-1 are eliminated downwards, rows count-1..middle+1 upwards; they meet in `middle`. On
    // the way a row's right side and its remaining off-diagonal entry are divided by its pivot.
    const std::size_t middle = count / 2;
    std::size_t i = 0;
    std::size_t j = count - 1;
    const auto down = [&] {
        if (i > 0) {
            diagonal[i] -= lower[i] * upper[i - 1];
            right[i] -= lower[i] * right[i - 1];
        }
        upper[i] /= diagonal[i];
        right[i] /= diagonal[i];
        ++i;
    };
    const auto up = [&] {
        if (j + 1 < count) {
            diagonal[j] -= upper[j] * lower[j + 1];
            right[j] -= upper[j] * right[j + 1];
        }
        lower[j] /= diagonal[j];
        right[j] /= diagonal[j];
        --j;
    };
    while (j > middle) {
        down();
        up();
    }
    if (i < middle) down();
    if (middle > 0) {
        diagonal[middle] -= lower[middle] * upper[middle - 1];
        right[middle] -= lower[middle] * right[middle - 1];
    }
    if (middle + 1 < count) {
        diagonal[middle] -= upper[middle] * lower[middle + 1];
        right[middle] -= upper[middle] * right[middle + 1];
    }
    right[middle] /= diagonal[middle];
    for (i = middle, j = middle + 1; i > 0 || j < count; ++j) {
        if (i > 0) {
            --i;
            right[i] -= upper[i] * right[i + 1];
        }
        if (j < count) right[j] -= lower[j] * right[j - 1];
    }
}

}  // namespace corda::sim
