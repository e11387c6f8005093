#include "corda/sim/exact/chain_closing.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "corda/core/cpu.hpp"
#include "corda/sim/four.hpp"

namespace corda::sim {
namespace {

/// A chain between two pins whose length exceeds their distance by less than this share is taut: its tensions
/// are not determined.
constexpr double kTaut = 1e-12;

/// Most Newton steps that close a chain between two pins, all with the matrix of the first. Each step
/// multiplies the gap by about its size relative to the chain, at most 1e-4 unless the links are nearly in
/// one line. They end once the gap is that of rounding in the sum of the links.
constexpr int kClosingSteps = 4;

/// The symmetric 2 x 2 matrix for closing a chain, the sum of a_i p_i p_i^T, plus a small multiple of the
/// identity: links in one line cannot move their end along it and must stay unchanged.
struct ClosingMatrix {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;

    void add(double length_m, Vec2 across) {
        xx += length_m * across.x * across.x;
        xy += length_m * across.x * across.y;
        yy += length_m * across.y * across.y;
    }
    /// The determinant in parts of the squared trace.
    [[nodiscard]] double regularity() const { return (xx * yy - xy * xy) / ((xx + yy) * (xx + yy)); }
    [[nodiscard]] Vec2 solve(Vec2 right) const {
        const double extra = 1e-14 * (xx + yy);
        const double x1 = xx + extra;
        const double y1 = yy + extra;
        const double determinant = x1 * y1 - xy * xy;
        return {(y1 * right.x - xy * right.y) / determinant, (x1 * right.y - xy * right.x) / determinant};
    }
};

/// Links between two pins, one entry each.
struct Links {
    std::size_t count;
    const double* length_m;
    double* c;  ///< directions
    double* s;
    double* omega_1_s;
};

CORDA_INLINE double sum(const Four& of) {
    return (of[0] + of[1]) + (of[2] + of[3]);
}

/// Sum of a_i (c_i, s_i), each times omega_i if `kTimesOmega`.
template <bool kTimesOmega>
CORDA_INLINE Vec2 sum_of_links(const Links& links) {
    Four x{};
    Four y{};
    std::size_t i = 0;
    for (; i + kFour <= links.count; i += kFour) {
        Four weight = any_four(links.length_m + i).value;
        if constexpr (kTimesOmega) weight *= any_four(links.omega_1_s + i).value;
        x += weight * any_four(links.c + i).value;
        y += weight * any_four(links.s + i).value;
    }
    Vec2 all{sum(x), sum(y)};
    for (; i < links.count; ++i) {
        const double weight = links.length_m[i] * (kTimesOmega ? links.omega_1_s[i] : 1.0);
        all = all + weight * Vec2{links.c[i], links.s[i]};
    }
    return all;
}

/// Where the chain ends, seen from its start, and how fast the end moves.
CORDA_AVX2_CLONES Vec2 end_m(const Links& links) {
    return sum_of_links<false>(links);
}
CORDA_AVX2_CLONES Vec2 end_velocity_m_s(const Links& links) {
    return left_of(sum_of_links<true>(links));
}

/// Turns each link by p_i . multiplier.
void turn(const Links& links, Vec2 multiplier) {
    for (std::size_t i = 0; i < links.count; ++i) {
        const Vec2 direction{links.c[i], links.s[i]};
        const Vec2 across = left_of(direction);
        const Vec2 turned = direction + dot(across, multiplier) * across;
        const double inverse = 1.0 / length(turned.x, turned.y);
        links.c[i] = inverse * turned.x;
        links.s[i] = inverse * turned.y;
    }
}

}  // namespace

void refuse_taut_between_pins(double length_m, Vec2 span_m, std::size_t from, std::size_t to) {
    if (length_m - length(span_m.x, span_m.y) > kTaut * length_m) return;
    throw Refusal(Refusal::Reason::kTautBetweenPins,
                  "method exact cannot work out the tensions of a rope that is taut between two pins "
                  "(particles " +
                      std::to_string(from) + " and " + std::to_string(to) + ", " + std::to_string(length_m) +
                      " m apart)");
}

Span span_at(const Chains& chains, const Chain& chain, double time_s) {
    const Chains::Pin& from = chains.pins[chain.start_pin];
    const Chains::Pin& to = chains.pins[chain.end_pin];
    return {chain.span_m + (to.displacement(time_s) - from.displacement(time_s)),
            to.velocity(time_s) - from.velocity(time_s)};
}

void close_between_pins(const Chains& chains, const Chain& chain, double time_s, double* y) {
    double* const c = y + chain.first_link;
    double* const s = c + chains.link_count();
    const Links links{chain.link_count, chains.length_m.data() + chain.first_link, c, s,
                      s + chains.link_count()};
    const auto [span_m, velocity_m_s] = span_at(chains, chain, time_s);
    if (dot(span_m, span_m) > chain.length_m * chain.length_m) {
        *c = std::numeric_limits<double>::quiet_NaN();
        return;
    }
    ClosingMatrix matrix;
    for (std::size_t i = 0; i < links.count; ++i) matrix.add(links.length_m[i], left_of({c[i], s[i]}));
    const double rounding_m =
        std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(links.count)) * chain.length_m;
    for (int k = 0; k < kClosingSteps; ++k) {
        const Vec2 open_m = span_m - end_m(links);
        // The first also makes directions of a series unit vectors.
        if (k > 0 && length(open_m.x, open_m.y) <= rounding_m) break;
        turn(links, matrix.solve(open_m));
    }
    const Vec2 multiplier = matrix.solve(velocity_m_s - end_velocity_m_s(links));
    for (std::size_t i = 0; i < links.count; ++i)
        links.omega_1_s[i] += dot(left_of({c[i], s[i]}), multiplier);
}

double spread(const Chains& chains, const Chain& chain, const double* y) {
    ClosingMatrix matrix;
    for (std::size_t i = chain.first_link; i < chain.first_link + chain.link_count; ++i)
        matrix.add(chains.length_m[i], {y[i], y[chains.link_count() + i]});
    return matrix.regularity();
}

}  // namespace corda::sim
