#pragma once

#include <array>
#include <vector>

#include "corda/sim/exact/radau_terms.hpp"

// The linear systems of a RadauChain: see section 12 of src/corda/sim/exact/README.md.
namespace corda::sim::radau {

/// A matrix of four numbers, row by row.
template <class Number>
using Block = std::array<Number, 4>;

template <class A, class Number>
CORDA_INLINE Block<Number> product(const Block<A>& a, const Block<Number>& b) {
    return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
            a[2] * b[1] + a[3] * b[3]};
}
/// `b` times `a`.
template <class Real>
CORDA_INLINE Block<ComplexOf<Real>> product_of_real(const Block<ComplexOf<Real>>& b, const Block<Real>& a) {
    return {a[0] * b[0] + a[2] * b[1], a[1] * b[0] + a[3] * b[1], a[0] * b[2] + a[2] * b[3],
            a[1] * b[2] + a[3] * b[3]};
}
template <class Real>
CORDA_INLINE Block<Real> product_of_real(const Block<Real>& b, const Block<Real>& a) {
    return product(b, a);
}

/// Complex numbers, one per link.
struct ComplexArray {
    double *re, *im;
};

/// A link, counted from 1.
struct One {
    using Real = double;
    Index link;

    [[nodiscard]] CORDA_INLINE double here(const double* x) const { return x[link]; }
    [[nodiscard]] CORDA_INLINE double before(const double* x) const { return x[link - 1]; }
    [[nodiscard]] CORDA_INLINE double after(const double* x) const { return x[link + 1]; }
    [[nodiscard]] CORDA_INLINE double joint_before(const double* x) const { return x[link - 1]; }
    [[nodiscard]] CORDA_INLINE double joint_after(const double* x) const { return x[link]; }
    /// Sines of joints have opposite signs for a link that is counted from the other end.
    [[nodiscard]] CORDA_INLINE static double sign() { return 1.0; }
    [[nodiscard]] CORDA_INLINE Complex here(ComplexArray x) const { return {x.re[link], x.im[link]}; }
    CORDA_INLINE void put(double value, double* x) const { x[link] = value; }
    CORDA_INLINE void put(Complex value, ComplexArray x) const {
        x.re[link] = value.re;
        x.im[link] = value.im;
    }
};

/// A link and its mirror image from the other end.
struct Pair {
    using Real = Two;
    Index link;
    Index mirrored;

    [[nodiscard]] CORDA_INLINE Two here(const double* x) const { return both(x[link], x[mirrored]); }
    [[nodiscard]] CORDA_INLINE Two before(const double* x) const {
        return both(x[link - 1], x[mirrored + 1]);
    }
    [[nodiscard]] CORDA_INLINE Two after(const double* x) const { return both(x[link + 1], x[mirrored - 1]); }
    [[nodiscard]] CORDA_INLINE Two joint_before(const double* x) const {
        return both(x[link - 1], x[mirrored]);
    }
    [[nodiscard]] CORDA_INLINE Two joint_after(const double* x) const {
        return both(x[link], x[mirrored - 1]);
    }
    [[nodiscard]] CORDA_INLINE static Two sign() { return both(1.0, -1.0); }
    [[nodiscard]] CORDA_INLINE ComplexOf<Two> here(ComplexArray x) const { return {here(x.re), here(x.im)}; }
    CORDA_INLINE void put(Two value, double* x) const {
        x[link] = value.lanes[0];
        x[mirrored] = value.lanes[1];
    }
    CORDA_INLINE void put(ComplexOf<Two> value, ComplexArray x) const {
        put(value.re, x.re);
        put(value.im, x.im);
    }
};

/// That of one of two links.
template <class Number>
CORDA_INLINE auto lane(const Block<Number>& a, int which) {
    return std::array{lane(a[0], which), lane(a[1], which), lane(a[2], which), lane(a[3], which)};
}

/// The blocks of a row next to that of the link itself, in the order of elimination.
template <class Real>
struct Neighbours {
    Block<Real> before, after;
};

/// A row of the factorised matrix.
template <class Number>
struct Pivot {
    Block<Number> inverse;  ///< of the pivot
    Block<Number> next;     ///< weights of the unknowns of the link that is eliminated next
};

/// The unknowns of a link: the angle it turns and its tension.
template <class Number>
struct Unknowns {
    Number turn = {};
    Number tension = {};
};

template <class A, class Number>
CORDA_INLINE Unknowns<Number> less(const Unknowns<Number>& x, const Block<A>& a, const Unknowns<Number>& y) {
    return {x.turn - (a[0] * y.turn + a[1] * y.tension), x.tension - (a[2] * y.turn + a[3] * y.tension)};
}
template <class Number>
CORDA_INLINE Unknowns<Number> times(const Block<Number>& a, const Unknowns<Number>& y) {
    return {a[0] * y.turn + a[1] * y.tension, a[2] * y.turn + a[3] * y.tension};
}

/// The Newton matrix at one state, link by link; the rows of a link are (4) and (3), or (16) and (17) if
/// links stretch.
template <bool kStretches>
struct Matrix {
    const double *length_m, *inverse_mass, *wc, *ws, *tension, *omega;
    // Of links that stretch.
    const double *stretch_m_n, *growth_m_s, *turning_1_s2;
    double drag_1_s;

    template <class Where>
    [[nodiscard]] CORDA_INLINE Neighbours<typename Where::Real> neighbours(Where at) const {
        const auto before_n = at.before(tension);
        const auto after_n = at.after(tension);
        const auto wc_before = at.joint_before(wc);
        const auto wc_after = at.joint_after(wc);
        const auto ws_before = at.sign() * at.joint_before(ws);
        const auto ws_after = at.sign() * at.joint_after(ws);
        return {{-1.0 * (wc_before * before_n), ws_before, ws_before * before_n, wc_before},
                {-1.0 * (wc_after * after_n), -1.0 * ws_after, -1.0 * (ws_after * after_n), wc_after}};
    }

    /// The pivot of a link whose block is less `filled` after the elimination of others. `rate`: an
    /// eigenvalue of B over the step. `square`: its square plus drag times it.
    template <class Where, class Number>
    [[nodiscard]] CORDA_INLINE Block<Number> inverse_pivot(Where at,
                                                           const Neighbours<typename Where::Real>& near,
                                                           const PullOf<typename Where::Real>& pull,
                                                           const Block<Number>& filled, Number rate,
                                                           Number square) const {
        using Real = typename Where::Real;
        const Real length = at.here(length_m);
        const Real omega_1_s = at.here(omega);
        const Real zero{};
        Number d00 = plus(length * square, pull.along - near.after[0] - near.before[0]) - filled[0];
        Number d01 = Number{} - filled[1];
        const Number d10 =
            plus((2.0 * (length * omega_1_s)) * rate, pull.across - near.after[2] - near.before[2]) -
            filled[2];
        Number d11 =
            plus(Number{} - filled[3], zero - (at.joint_before(inverse_mass) + at.joint_after(inverse_mass)));
        if constexpr (kStretches) {
            const Real stretch = at.here(stretch_m_n);
            d00 = d00 + (2.0 * at.here(growth_m_s)) * rate;
            d01 = plus(d01 + (2.0 * (stretch * omega_1_s)) * rate,
                       stretch * (at.here(turning_1_s2) + drag_1_s * omega_1_s));
            d11 = plus(d11 - stretch * square, stretch * (omega_1_s * omega_1_s));
        }
        const Number scale = inverse(d00 * d11 - d01 * d10);
        return {d11 * scale, Number{} - d01 * scale, Number{} - d10 * scale, d00 * scale};
    }
};

/// The matrix with one eigenvalue, eliminated from both ends of the chain at once: pairs of links first, then
/// the one or two in the middle.
template <class Number, class NumberOfPair>
struct Elimination {
    std::vector<Pivot<NumberOfPair>> pairs;  ///< from index 1 on; the weights of pair 0 are 0
    std::array<Pivot<Number>, 2> middle = {};

    void resize(Index links) { pairs.assign((links + 1) / 2, {}); }
    [[nodiscard]] CORDA_INLINE Index pair_count() const { return pairs.size() - 1; }

    template <bool kStretches>
    CORDA_INLINE void eliminate(const Matrix<kStretches>& matrix, Pair at, const Neighbours<Two>& near,
                                const PullOf<Two>& pull, NumberOfPair rate, NumberOfPair square) {
        const Block<NumberOfPair> filled = product(near.before, pairs[at.link - 1].next);
        Pivot<NumberOfPair>& pivot = pairs[at.link];
        pivot.inverse = matrix.inverse_pivot(at, near, pull, filled, rate, square);
        pivot.next = product_of_real(pivot.inverse, near.after);
    }

    /// `pull_at(i)`: the Pull on a link.
    template <bool kStretches, class PullAt>
    void eliminate_middle(const Matrix<kStretches>& matrix, Index links, const PullAt& pull_at, Number rate,
                          Number square) {
        const Index first = pair_count() + 1;
        const Index last = links - pair_count();
        Block<Number> next = lane(pairs.back().next, 0);
        for (Index i = first; i <= last; ++i) {
            const Neighbours<double> near = matrix.neighbours(One{i});
            Block<Number> filled = product(near.before, next);
            if (i == last) {
                const Block<Number> from_the_end = product(near.after, lane(pairs.back().next, 1));
                for (Index k = 0; k < 4; ++k) filled[k] = filled[k] + from_the_end[k];
            }
            Pivot<Number>& pivot = middle[i - first];
            pivot.inverse = matrix.inverse_pivot(One{i}, near, pull_at(i), filled, rate, square);
            pivot.next = product_of_real(pivot.inverse, near.after);
            next = pivot.next;
        }
    }
};

/// Solves a system after its elimination, in place: `turn` and `tension` are right-hand sides, then
/// solutions.
template <class Number, class NumberOfPair, class Array>
struct Substitution {
    const Elimination<Number, NumberOfPair>& of;
    Array turn, tension;
    Unknowns<NumberOfPair> last = {};  ///< of the last pair

    Substitution(const Elimination<Number, NumberOfPair>& after, Array turns, Array tensions)
        : of(after), turn(turns), tension(tensions) {}

    CORDA_INLINE void forward(Pair at, const Neighbours<Two>& near) {
        const Unknowns<NumberOfPair> right{at.here(turn), at.here(tension)};
        last = times(of.pairs[at.link].inverse, less(right, near.before, last));
        put(at, last);
    }

    template <bool kStretches>
    void middle(const Matrix<kStretches>& matrix, Index links) {
        const Index first = of.pair_count() + 1;
        const Index end = links - of.pair_count();
        const Unknowns<Number> far{lane(last.turn, 1), lane(last.tension, 1)};
        Unknowns<Number> here{lane(last.turn, 0), lane(last.tension, 0)};
        std::array<Unknowns<Number>, 2> solved;
        for (Index i = first; i <= end; ++i) {
            const Neighbours<double> near = matrix.neighbours(One{i});
            Unknowns<Number> right = less({One{i}.here(turn), One{i}.here(tension)}, near.before, here);
            if (i == end) right = less(right, near.after, far);
            here = solved[i - first] = times(of.middle[i - first].inverse, right);
        }
        if (end > first) solved[0] = less(solved[0], of.middle[0].next, solved[1]);
        for (Index i = first; i <= end; ++i) put(One{i}, solved[i - first]);
        const Unknowns<Number>& far_side = solved[end - first];
        last = {both(solved[0].turn, far_side.turn), both(solved[0].tension, far_side.tension)};
    }

    CORDA_INLINE void back(Pair at) {
        const Unknowns<NumberOfPair> right{at.here(turn), at.here(tension)};
        last = less(right, of.pairs[at.link].next, last);
        put(at, last);
    }

  private:
    template <class Where, class Value>
    CORDA_INLINE void put(Where at, const Unknowns<Value>& value) const {
        at.put(value.turn, turn);
        at.put(value.tension, tension);
    }
};

}  // namespace corda::sim::radau
