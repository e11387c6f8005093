#pragma once

#include <cstddef>

// Four numbers at a time, for functions that are compiled for registers of that width too.

#define CORDA_INLINE [[gnu::always_inline]] inline

namespace corda::sim {

/// How many numbers a Four has.
inline constexpr std::size_t kFour = 4;

using Four [[gnu::vector_size(kFour * sizeof(double))]] = double;
using FourBits [[gnu::vector_size(kFour * sizeof(double))]] = long long;
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

/// The last of `before` and the first three of `here`. From registers, because a load that spans two stores
/// just made would wait until both are in the cache.
CORDA_INLINE void shift_up(const Four& before, const Four& here, Four& result) {
    result = __builtin_shufflevector(before, here, 3, 4, 5, 6);
}
/// The last three of `here` and the first of `after`.
CORDA_INLINE void shift_down(const Four& here, const Four& after, Four& result) {
    result = __builtin_shufflevector(here, after, 1, 2, 3, 4);
}

/// For angles below this, cosine_sine() uses the polynomials alone.
inline constexpr double kSmallAngle = 0.78;

/// Cosine and sine of angles below kSmallAngle, with the bits of cosine_sine().
CORDA_INLINE void cosine_sine_of_small(const Four& x, Four& cosine, Four& sine) {
    const Four z = x * x;
    sine = x + x * z *
                   (-1.66666666666666324348e-01 +
                    z * (8.33333333332248946124e-03 +
                         z * (-1.98412698298579493134e-04 +
                              z * (2.75573137070700676789e-06 +
                                   z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    cosine = 1.0 - 0.5 * z +
             z * z *
                 (4.16666666666666019037e-02 +
                  z * (-1.38888888888741095749e-03 +
                       z * (2.48015872894767294178e-05 +
                            z * (-2.75573143513906633035e-07 +
                                 z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
}

/// Cosine and sine of angles up to about 1e5, good to the last digit, from +, - and * alone. Source: the
/// polynomials of fdlibm (Sun Microsystems 1993), k_cos.c and k_sin.c, after a whole number of right angles
/// is subtracted in two parts.
CORDA_INLINE void cosine_sine(const Four& angle, Four& cosine, Four& sine) {
    constexpr double kRounds = 0x1.8p+52;  // a sum with it has no digits after the point
    const Four turns = angle * 6.36619772367581382433e-01 + kRounds;
    const FourBits quarter = reinterpret_cast<FourBits>(turns);
    const Four whole = turns - kRounds;
    const Four x = (angle - whole * 1.57079632673412561417e+00) - whole * 6.07710050650619224932e-11;
    Four c;
    Four s;
    cosine_sine_of_small(x, c, s);
    const FourBits c_bits = reinterpret_cast<FourBits>(c);
    const FourBits s_bits = reinterpret_cast<FourBits>(s);
    const FourBits odd = -(quarter & 1);  // all bits, or none
    const FourBits cosine_bits = ((~odd & c_bits) | (odd & s_bits)) ^ (((quarter + 1) & 2) << 62);
    const FourBits sine_bits = ((~odd & s_bits) | (odd & c_bits)) ^ ((quarter & 2) << 62);
    cosine = reinterpret_cast<Four>(cosine_bits);
    sine = reinterpret_cast<Four>(sine_bits);
}

}  // namespace corda::sim
