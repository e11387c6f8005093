#pragma once

#include <cstddef>

namespace corda::sim {

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
