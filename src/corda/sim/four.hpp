#pragma once

#include <cstddef>

#include "corda/core/cpu.hpp"

namespace corda::sim {

inline constexpr std::size_t kFour = 4;
/// Four numbers at a time, for functions that are also compiled for registers of that width.
using Four [[gnu::vector_size(kFour * sizeof(double))]] = double;
// References, because how such a type is passed by value depends on the CPU.
CORDA_INLINE const Four& four(const double* x) {
    return *reinterpret_cast<const Four*>(x);
}
CORDA_INLINE Four& four(double* x) {
    return *reinterpret_cast<Four*>(x);
}
/// Four numbers that need not be aligned to a register's size. A struct, because clang++ forgets the smaller
/// alignment of a reference to a vector type.
struct [[gnu::packed, gnu::may_alias]] AnyFour {
    Four value;
};
CORDA_INLINE const AnyFour& any_four(const double* x) {
    return *reinterpret_cast<const AnyFour*>(x);
}
CORDA_INLINE AnyFour& any_four(double* x) {
    return *reinterpret_cast<AnyFour*>(x);
}

/// The least number of rows that fills whole Fours and has room for `rows`.
[[nodiscard]] constexpr std::size_t up_to_four(std::size_t rows) {
    return (rows + kFour - 1) / kFour * kFour;
}
/// The first row of the Four that `row` belongs to.
[[nodiscard]] constexpr std::size_t down_to_four(std::size_t row) {
    return row / kFour * kFour;
}

}  // namespace corda::sim
