#pragma once

#include <array>
#include <cstddef>

#include "corda/sim/exact/series_terms.hpp"

// The numbers of a RadauChain: see section 12 of src/corda/sim/exact/README.md.
namespace corda::sim::radau {

using Index = std::size_t;

/// Two numbers, of a link and of its mirror image from the other end: one instruction for both. A struct,
/// because templates ignore the attributes of a vector.
using TwoLanes [[gnu::vector_size(16)]] = double;
struct Two {
    TwoLanes lanes;
};
CORDA_INLINE Two operator+(Two a, Two b) {
    return {a.lanes + b.lanes};
}
CORDA_INLINE Two operator-(Two a, Two b) {
    return {a.lanes - b.lanes};
}
CORDA_INLINE Two operator*(Two a, Two b) {
    return {a.lanes * b.lanes};
}
CORDA_INLINE Two operator*(double a, Two b) {
    return {a * b.lanes};
}

/// A complex number, or two. Unlike those of std::complex, its products do not search for infinities.
template <class Real>
struct ComplexOf {
    Real re = {};
    Real im = {};
};
using Complex = ComplexOf<double>;

CORDA_INLINE Two both(double a, double b) {
    const TwoLanes lanes{a, b};
    return Two{lanes};
}
CORDA_INLINE ComplexOf<Two> both(Complex a, Complex b) {
    return {both(a.re, b.re), both(a.im, b.im)};
}
/// One of two numbers.
CORDA_INLINE double lane(Two a, int which) {
    return a.lanes[which];
}
CORDA_INLINE Complex lane(ComplexOf<Two> a, int which) {
    return {a.re.lanes[which], a.im.lanes[which]};
}

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

/// Cosines and sines, one per link or joint.
template <class Number>
struct Directions {
    Number* c;
    Number* s;
};

/// The slope at stage `k`, times the step, of the polynomial that is 0 at the start and has these values at
/// the stages.
CORDA_INLINE double slope_at(Index k, double first, double middle, double last) {
    return kB[k][0] * first + kB[k][1] * middle + kB[k][2] * last;
}

/// The values of something at the stages. No array, because loops over stages inside one over links keep it
/// from being compiled for several links at a time.
struct Three {
    double first, middle, last;

    /// Slopes at the stages of what starts at `start`, per step.
    [[nodiscard]] CORDA_INLINE Three slopes(double start, double per_step) const {
        const double x = first - start;
        const double y = middle - start;
        const double z = last - start;
        return {per_step * slope_at(0, x, y, z), per_step * slope_at(1, x, y, z),
                per_step * slope_at(2, x, y, z)};
    }
    [[nodiscard]] CORDA_INLINE double weighted(const double (&weight)[3]) const {
        return weight[0] * first + weight[1] * middle + weight[2] * last;
    }
};

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

template <class Real>
CORDA_INLINE ComplexOf<Real> operator+(ComplexOf<Real> a, ComplexOf<Real> b) {
    return {a.re + b.re, a.im + b.im};
}
template <class Real>
CORDA_INLINE ComplexOf<Real> operator-(ComplexOf<Real> a, ComplexOf<Real> b) {
    return {a.re - b.re, a.im - b.im};
}
template <class Real>
CORDA_INLINE ComplexOf<Real> operator*(ComplexOf<Real> a, ComplexOf<Real> b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <class Real>
CORDA_INLINE ComplexOf<Real> operator*(Real a, ComplexOf<Real> b) {
    return {a * b.re, a * b.im};
}
CORDA_INLINE double inverse(double a) {
    return 1.0 / a;
}
CORDA_INLINE Two inverse(Two a) {
    return {1.0 / a.lanes};
}
template <class Real>
CORDA_INLINE ComplexOf<Real> inverse(ComplexOf<Real> a) {
    const Real scale = inverse(a.re * a.re + a.im * a.im);
    return {a.re * scale, (-1.0 * a.im) * scale};
}
template <class Real>
CORDA_INLINE Real plus(Real a, Real b) {
    return a + b;
}
template <class Real>
CORDA_INLINE ComplexOf<Real> plus(ComplexOf<Real> a, Real b) {
    return {a.re + b, a.im};
}

/// Pull on a link at a pin, which the pin withholds, along the link and to its left.
template <class Real>
struct PullOf {
    Real along = {};
    Real across = {};
};
using Pull = PullOf<double>;

/// That of the uniform acceleration once the link, which led along (c, s), has turned.
inline Pull pull_of(Vec2 uniform_m_s2, double c, double s, double turn) {
    const auto [turn_c, turn_s] = cosine_sine_of_small(turn);
    const Vec2 direction{c * turn_c - s * turn_s, s * turn_c + c * turn_s};
    return {dot(uniform_m_s2, direction), dot(uniform_m_s2, left_of(direction))};
}

}  // namespace corda::sim::radau
