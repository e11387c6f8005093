#pragma once

#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"

namespace corda::sim {

/// For angles below this, cosine_sine() uses the polynomials alone.
inline constexpr double kSmallAngle = 0.78;

/// Of one or four angles.
template <class X>
struct CosineSine {
    X cosine;
    X sine;
};

/// Cosine and sine of one or four angles below kSmallAngle, with the bits of cosine_sine().
template <class X>
CORDA_INLINE CosineSine<X> cosine_sine_of_small(const X& x) {
    const X z = x * x;
    const X sine =
        x + x * z *
                (-1.66666666666666324348e-01 +
                 z * (8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 +
                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const X cosine =
        1.0 - 0.5 * z +
        z * z *
            (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    return {cosine, sine};
}

/// A vector turned by the angle of this cosine and sine.
inline Vec2 turned(Vec2 v, Vec2 cosine_sine) {
    return cosine_sine.x * v + cosine_sine.y * left_of(v);
}

}  // namespace corda::sim
