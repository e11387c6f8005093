#pragma once

#include <cstdint>
#include <vector>

#include "corda/core/stop_check.hpp"

namespace corda::sim {

/// A linear complementarity problem with a symmetric tridiagonal matrix A, positive semidefinite: find z >= 0
/// with w = A z - b >= 0 and z_k w_k = 0.
struct TridiagonalLcp {
    std::vector<double> diagonal;  ///< A_kk > 0
    std::vector<double> beside;    ///< A_k,k+1; one less, the last entry is not read
    std::vector<double> right;     ///< b
};

/// Guesses which z_k are positive: 1 where they are, 0 where w_k is. Near the guess's own limit, where both
/// are 0 or almost, an entry may be either.
///
/// Pivoting changes one row at a time in the worst case, and each change costs a solution of all rows: the
/// square of their number. This takes some 30 solutions whatever the number of rows is and at most 100. It is
/// Mehrotra's predictor-corrector method. Source: S. Wright, Primal-Dual Interior-Point Methods, SIAM 1997,
/// ch. 8 and 10.
[[nodiscard]] std::vector<std::uint8_t> guess_positive(TridiagonalLcp problem, StopCheck& stop);

}  // namespace corda::sim
