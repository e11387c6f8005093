#pragma once

#include <array>
#include <cstddef>

#include "corda/sim/exact/series_terms.hpp"

// The linear algebra of a RadauChain: see section 12 of src/corda/sim/exact/README.md.
namespace corda::sim::radau {

using Index = std::size_t;

/// A complex number. Unlike those of std::complex, its products do not search for infinities.
struct Complex {
    double re = 0.0;
    double im = 0.0;
};

// Radau IIA of order 5: the stages' times, the inverse B of its matrix, the eigenvalues of B, and
// B = kFrom diag(kReal, kPair) kTo, where the pair acts on the last two components as on re + i im.
inline constexpr std::array<double, 3> kTime{0.15505102572168219, 0.64494897427831781, 1.0};
inline constexpr double kB[3][3] = {{3.2247448713915890491, 1.1678400846904054949, -0.25319726474218082619},
                                    {-3.5678400846904054949, 0.77525512860841095090, 1.0531972647421808262},
                                    {5.5319726474218082619, -7.5319726474218082619, 5.0}};
inline constexpr double kReal = 3.6378342527444957322;
inline constexpr Complex kPair{2.6810828736277521339, 3.0504301992474105694};
inline constexpr double kFrom[3][3] = {
    {9.1232394870892942792e-2, -0.14125529502095420843, -3.0029194105147424492e-2},
    {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
    {0.96604818261509293619, 1.0, 0.0}};
inline constexpr double kTo[3][3] = {
    {4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119},
    {-4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196},
    {-0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497}};
/// Weights of the stages in the error estimate.
inline constexpr double kErrorWeights[3] = {-10.048809399827415562, 1.3821427331607488958,
                                            -0.33333333333333333333};

/// A matrix of four numbers, row by row.
template <class Number>
using Block = std::array<Number, 4>;

/// Cosines and sines, one per link or joint.
template <class Number>
struct Directions {
    Number* c;
    Number* s;
};

/// A row of the factorised matrix.
template <class Number>
struct Pivot {
    Block<Number> inverse;  ///< of the pivot
    Block<Number> next;     ///< weights of the next link's unknowns
};

/// The slope at stage `k`, times the step, of the polynomial that is 0 at the start and has these values at
/// the stages.
CORDA_INLINE double slope_at(Index k, double first, double middle, double last) {
    return kB[k][0] * first + kB[k][1] * middle + kB[k][2] * last;
}

/// The polynomial through the values of the last step's stages at `time`, in parts of that step.
inline std::array<double, 3> weights_of_stages(double time, bool starts_at_0) {
    std::array<double, 3> weights{1.0, 1.0, 1.0};
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j)
            if (j != k) weights[k] *= (time - kTime[j]) / (kTime[k] - kTime[j]);
        if (starts_at_0) weights[k] *= time / kTime[k];
    }
    return weights;
}

CORDA_INLINE Complex operator+(Complex a, Complex b) {
    return {a.re + b.re, a.im + b.im};
}
CORDA_INLINE Complex operator-(Complex a, Complex b) {
    return {a.re - b.re, a.im - b.im};
}
CORDA_INLINE Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
CORDA_INLINE Complex operator*(double a, Complex b) {
    return {a * b.re, a * b.im};
}
CORDA_INLINE Complex plus(Complex a, double b) {
    return {a.re + b, a.im};
}
CORDA_INLINE double plus(double a, double b) {
    return a + b;
}
CORDA_INLINE Complex inverse(Complex a) {
    const double scale = 1.0 / (a.re * a.re + a.im * a.im);
    return {a.re * scale, -a.im * scale};
}
CORDA_INLINE double inverse(double a) {
    return 1.0 / a;
}

template <class A, class Number>
CORDA_INLINE Block<Number> product(const Block<A>& a, const Block<Number>& b) {
    return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
            a[2] * b[1] + a[3] * b[3]};
}
CORDA_INLINE Block<Complex> product(const Block<Complex>& a, const Block<double>& b) {
    return {b[0] * a[0] + b[2] * a[1], b[1] * a[0] + b[3] * a[1], b[0] * a[2] + b[2] * a[3],
            b[1] * a[2] + b[3] * a[3]};
}

/// Pull on the first link, which the pin withholds, along the link and to its left.
struct Pull {
    double along = 0.0;
    double across = 0.0;
};

/// That of the uniform acceleration once the link, which led along (c, s), has turned.
inline Pull pull_of(Vec2 uniform_m_s2, double c, double s, double turn) {
    const auto [turn_c, turn_s] = cosine_sine_of_small(turn);
    const Vec2 direction{c * turn_c - s * turn_s, s * turn_c + c * turn_s};
    return {dot(uniform_m_s2, direction), dot(uniform_m_s2, left_of(direction))};
}

/// The Newton matrix at one state, link by link; the rows of a link are (4) and (3).
struct Matrix {
    const double *length_m, *inverse_mass, *wc, *ws, *tension, *omega;

    [[nodiscard]] CORDA_INLINE Block<double> lower(Index i) const {
        return {-wc[i - 1] * tension[i - 1], ws[i - 1], ws[i - 1] * tension[i - 1], wc[i - 1]};
    }
    [[nodiscard]] CORDA_INLINE Block<double> upper(Index i) const {
        return {-wc[i] * tension[i + 1], -ws[i], -ws[i] * tension[i + 1], wc[i]};
    }

    /// Eliminates link `i` after link i - 1. `rate`: an eigenvalue of B over the step. `square`: its square
    /// plus drag times it.
    template <class Number>
    CORDA_INLINE void eliminate(Index i, const Pull& pull, Number rate, Number square,
                                Pivot<Number>* pivots) const {
        const Block<double> l = lower(i);
        const Block<double> u = upper(i);
        const Block<Number> filled = product(l, pivots[i - 1].next);
        const Number d00 = plus(length_m[i] * square, pull.along - u[0] - l[0]) - filled[0];
        const Number d01 = Number{} - filled[1];
        const Number d10 = plus((2.0 * length_m[i] * omega[i]) * rate, pull.across - u[2] - l[2]) - filled[2];
        const Number d11 = plus(Number{} - filled[3], -(inverse_mass[i - 1] + inverse_mass[i]));
        const Number scale = inverse(d00 * d11 - d01 * d10);
        Pivot<Number>& pivot = pivots[i];
        pivot.inverse = {d11 * scale, Number{} - d01 * scale, Number{} - d10 * scale, d00 * scale};
        pivot.next = product(pivot.inverse, u);
    }

    template <class Number>
    CORDA_INLINE void forward(Index i, const Pivot<Number>& pivot, Number* x, Number* t) const {
        const Block<double> l = lower(i);
        const Number r0 = x[i] - (l[0] * x[i - 1] + l[1] * t[i - 1]);
        const Number r1 = t[i] - (l[2] * x[i - 1] + l[3] * t[i - 1]);
        x[i] = pivot.inverse[0] * r0 + pivot.inverse[1] * r1;
        t[i] = pivot.inverse[2] * r0 + pivot.inverse[3] * r1;
    }
};

template <class Number>
CORDA_INLINE void backward(Index i, const Pivot<Number>& pivot, Number* x, Number* t) {
    x[i] = x[i] - (pivot.next[0] * x[i + 1] + pivot.next[1] * t[i + 1]);
    t[i] = t[i] - (pivot.next[2] * x[i + 1] + pivot.next[3] * t[i + 1]);
}

}  // namespace corda::sim::radau
